#include "repair/holes/repair_mesh.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

#include "core/index_sets.h"
#include "geometry/box.h"
#include "geometry/triangle_list.h"
#include "geometry/weld.h"
#include "geometry/world_vector.h"
#include "isoshell/repair.h"

namespace isoshell::repair {
namespace {

Corners smallest_first(Corners t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

}  // namespace

RepairMesh::RepairMesh(const TriangleSoup& soup) {
  WeldedVertices vertices = weld_vertices(soup.vertices, soup.triangles);
  position = std::move(vertices.position);
  welded_ = std::move(vertices.place);
  list_faces(soup);
  list_edges();
  if (!join_cracks()) return;
  list_faces(soup);
  list_edges();
}

void RepairMesh::list_faces(const TriangleSoup& soup) {
  struct Sourced {
    Corners corner;
    uint32_t source;
    /// Of a face and its mirror image the same one.
    Corners unsided() const { return corner[1] < corner[2] ? corner : Corners{corner[0], corner[2], corner[1]}; }
    bool operator<(const Sourced& o) const {
      const Corners a = unsided(), b = o.unsided();
      if (a != b) return a < b;
      return corner != o.corner ? corner < o.corner : source < o.source;
    }
  };
  std::vector<Sourced> all;
  all.reserve(soup.triangles.size());
  for (uint32_t i = 0; i < soup.triangles.size(); ++i) {
    const Corners& t = soup.triangles[i];
    const Corners c = {welded_[t[0]], welded_[t[1]], welded_[t[2]]};
    if (!repeats_corner(c)) all.push_back({smallest_first(c), i});
  }
  tbb::parallel_sort(all.begin(), all.end());
  face.clear();
  source.clear();
  repeats_ = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    if (i > 0 && all[i].unsided() == all[i - 1].unsided()) {
      ++repeats_;
      continue;
    }
    face.push_back(all[i].corner);
    source.push_back(all[i].source);
  }
  live_.assign(face.size(), 1);
  turned_.assign(face.size(), 0);
}

void RepairMesh::list_edges() {
  sides_ = find_edge_sides(face, position.size());
  edge_first_.assign(1, 0);
  edge_of_.resize(3 * face.size());
  live_at_.clear();
  for_each_edge(sides_, [&](uint32_t, uint32_t, View<const EdgeSide> on_edge) {
    for (const EdgeSide& side : on_edge) edge_of_[side.half_edge] = uint32_t(live_at_.size());
    live_at_.push_back(uint32_t(on_edge.size));
    edge_first_.push_back(edge_first_.back() + live_at_.back());
  });
}

/// Per vertex how far another one may be to be the same: 0 away from boundaries.
std::vector<double> RepairMesh::crack_widths() const {
  std::vector<double> width(position.size(), 0);
  if (position.empty()) return width;
  const WorldBox box = box_of(position);
  const double widest = kWidestCrack * length(box.max - box.min);
  for (uint32_t h = 0; h < edge_of_.size(); ++h) {
    if (live_at_[edge_of_[h]] != 1) continue;
    const WorldPoint &p = position[from(h)], &q = position[to(h)];
    const double most = length(q - p) / 4;
    for (const uint32_t v : {from(h), to(h)}) width[v] = std::min(width[v] > 0 ? width[v] : widest, most);
  }
  return width;
}

/// Per vertex of a boundary the first one that lies within both their widths; per other vertex itself.
std::vector<uint32_t> RepairMesh::first_within_cracks() const {
  const std::vector<double> width = crack_widths();
  // Cells as wide as the widths of the vertices in them, up to the next power of two: a grid for each.
  using Cell = std::array<int64_t, 4>;
  const auto cell_at = [&](const WorldPoint& p, int level) {
    const auto along = [&](double at) { return int64_t(std::clamp(std::floor(std::ldexp(at, -level)), -4e18, 4e18)); };
    return Cell{level, along(p.x - position[0].x), along(p.y - position[0].y), along(p.z - position[0].z)};
  };
  std::set<int> levels;
  std::map<Cell, std::vector<uint32_t>> kept;
  std::vector<uint32_t> first(position.size());
  for (uint32_t v = 0; v < first.size(); ++v) {
    first[v] = v;
    if (!(width[v] > 0) || std::isinf(width[v])) continue;
    for (const int level : levels) {
      const Cell at = cell_at(position[v], level);
      for (int n = 0; n < 27; ++n) {
        const auto near = kept.find({level, at[1] + n / 9 - 1, at[2] + n / 3 % 3 - 1, at[3] + n % 3 - 1});
        if (near == kept.end()) continue;
        for (const uint32_t u : near->second)
          if (u < first[v] && length(position[u] - position[v]) <= std::min(width[u], width[v])) first[v] = u;
      }
    }
    if (first[v] != v) continue;
    const int level = std::ilogb(width[v]) + 1;
    levels.insert(level);
    kept[cell_at(position[v], level)].push_back(v);
  }
  return first;
}

/// Joins boundaries that lie on each other edge by edge, two that run in opposite directions, as a whole or not at all.
bool RepairMesh::join_cracks() {
  const std::vector<uint32_t> first = first_within_cracks();
  std::map<uint64_t, std::vector<uint32_t>> at;
  IndexSets sets(int64_t(position.size()));
  for (uint32_t h = 0; h < edge_of_.size(); ++h) {
    if (live_at_[edge_of_[h]] != 1) continue;
    at[edge_key(first[from(h)], first[to(h)])].push_back(h);
    for (const uint32_t v : {to(h), first[from(h)], first[to(h)]}) sets.unite(from(h), v);
  }
  std::vector<uint8_t> stays(position.size(), 0);  // per root
  for (const auto& [key, halves] : at)
    if (halves.size() != 2 || first[from(halves[0])] != first[to(halves[1])]) stays[sets.root(from(halves[0]))] = 1;
  const auto becomes = [&](uint32_t v) { return stays[sets.root(v)] ? v : first[v]; };
  for (uint32_t v = 0; v < position.size(); ++v) joined_ += becomes(v) != v;
  for (uint32_t& v : welded_) v = becomes(v);
  return joined_ > 0;
}

void RepairMesh::drop(uint32_t f) {
  live_[f] = 0;
  for (uint32_t h = 3 * f; h < 3 * f + 3; ++h) --live_at_[edge_of_[h]];
}

void RepairMesh::turn(uint32_t f) {
  turned_[f] ^= 1;
  // Corners 1 and 2 change places: half-edges 0 and 2 change edges.
  std::swap(face[f][1], face[f][2]);
  const uint32_t h = 3 * f, g = 3 * f + 2, e = edge_of_[h], d = edge_of_[g];
  for (uint32_t i = edge_first_[e]; i < edge_first_[e + 1]; ++i)
    if (sides_.items[i].half_edge == h) sides_.items[i].half_edge = g;
  for (uint32_t i = edge_first_[d]; i < edge_first_[d + 1]; ++i)
    if (sides_.items[i].half_edge == g) sides_.items[i].half_edge = h;
  std::swap(edge_of_[h], edge_of_[g]);
}

uint32_t RepairMesh::twin(uint32_t half_edge) const {
  const uint32_t e = edge_of_[half_edge];
  for (uint32_t i = edge_first_[e]; i < edge_first_[e + 1]; ++i)
    if (const uint32_t h = sides_.items[i].half_edge; h != half_edge && live_[h / 3]) return h;
  return half_edge;
}

bool RepairMesh::has_edge(uint32_t a, uint32_t b) const {
  const View<const EdgeSide> sides = sides_.in(std::min(a, b));
  const auto at = std::lower_bound(sides.begin(), sides.end(), std::max(a, b),
                                   [](const EdgeSide& side, uint32_t end) { return side.larger_end < end; });
  return at != sides.end() && at->larger_end == std::max(a, b) && live_at_[edge_of_[at->half_edge]] > 0;
}

WorldPoint RepairMesh::doubled_area(uint32_t f) const {
  const WorldPoint &a = position[face[f][0]], &b = position[face[f][1]], &c = position[face[f][2]];
  return isoshell::doubled_area(a, b, c);
}

double RepairMesh::area(uint32_t f) const { return length(doubled_area(f)) / 2; }

}  // namespace isoshell::repair
