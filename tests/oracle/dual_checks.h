// The four checks of the dual by brute force, and the faces of a labelling.
#pragma once

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <vector>

#include "isoshell/advanced/sheet.h"

namespace isoshell::oracle {

using Edge = std::pair<uint32_t, uint32_t>;
inline Edge edge(uint32_t a, uint32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// Number of connected sets among `vertices` along `edges`.
inline int64_t count_pieces(const std::set<uint32_t>& vertices, const std::set<Edge>& edges) {
  std::map<uint32_t, std::vector<uint32_t>> next;
  for (const Edge& e : edges) {
    next[e.first].push_back(e.second);
    next[e.second].push_back(e.first);
  }
  std::set<uint32_t> seen;
  int64_t pieces = 0;
  for (uint32_t start : vertices) {
    if (!seen.insert(start).second) continue;
    ++pieces;
    std::vector<uint32_t> stack{start};
    while (!stack.empty()) {
      const uint32_t v = stack.back();
      stack.pop_back();
      for (uint32_t w : next[v])
        if (seen.insert(w).second) stack.push_back(w);
    }
  }
  return pieces;
}

struct DualChecks {
  int64_t cells_in_pieces = 0, cells_not_disks = 0, bad_pairs = 0, small_components = 0, empty_seeds = 0;
  std::vector<std::array<uint32_t, 3>> faces;  ///< canonical, sorted, repeats kept
  bool all_pass() const {
    return !cells_in_pieces && !cells_not_disks && !bad_pairs && !small_components && !empty_seeds;
  }
};

inline DualChecks check_labels(const Sheet& sheet, const std::vector<uint32_t>& label, int64_t seeds) {
  struct Cell {
    std::set<uint32_t> vertices;
    std::set<Edge> edges;
    int64_t faces = 0;
  };
  std::vector<Cell> cells(static_cast<size_t>(seeds));
  for (uint32_t v = 0; v < label.size(); ++v) cells[label[v]].vertices.insert(v);
  DualChecks out;
  std::map<Edge, int> pairs;
  std::set<uint32_t> all_cells;
  std::set<Edge> meeting;
  for (const TriangleIndices& t : sheet.triangles) {
    const std::array<uint32_t, 3> v = {t.a, t.b, t.c}, l = {label[t.a], label[t.b], label[t.c]};
    for (int i = 0; i < 3; ++i) {
      const int j = (i + 1) % 3;
      if (l[i] == l[j])
        cells[l[i]].edges.insert(edge(v[i], v[j]));
      else {
        meeting.insert(edge(l[i], l[j]));
        pairs.try_emplace(edge(l[i], l[j]), 0);
      }
    }
    if (l[0] == l[1] && l[1] == l[2]) ++cells[l[0]].faces;
    if (l[0] == l[1] || l[1] == l[2] || l[2] == l[0]) continue;
    for (int i = 0; i < 3; ++i) ++pairs[edge(l[i], l[(i + 1) % 3])];
    std::array<uint32_t, 3> face = l;
    std::rotate(face.begin(), std::min_element(face.begin(), face.end()), face.end());
    out.faces.push_back(face);
  }
  std::sort(out.faces.begin(), out.faces.end());
  for (uint32_t s = 0; s < cells.size(); ++s) {
    const Cell& c = cells[s];
    if (c.vertices.empty()) {
      ++out.empty_seeds;
      continue;
    }
    all_cells.insert(s);
    out.cells_in_pieces += count_pieces(c.vertices, c.edges) != 1;
    out.cells_not_disks += int64_t(c.vertices.size()) - int64_t(c.edges.size()) + c.faces != 1;
  }
  for (const auto& [pair, count] : pairs) out.bad_pairs += count != 2;
  std::map<uint32_t, std::set<uint32_t>> next;
  for (const Edge& e : meeting) next[e.first].insert(e.second), next[e.second].insert(e.first);
  std::set<uint32_t> seen;
  for (uint32_t start : all_cells) {
    if (seen.count(start)) continue;
    std::vector<uint32_t> component{start};
    seen.insert(start);
    for (size_t i = 0; i < component.size(); ++i)
      for (uint32_t w : next[component[i]])
        if (seen.insert(w).second) component.push_back(w);
    out.small_components += component.size() < 4;
  }
  return out;
}

}  // namespace isoshell::oracle
