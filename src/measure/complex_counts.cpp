// Counts of a complex: half-edges by edge, corners joined into fans, fans and edges summed by component.
#include "measure/complex_counts.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/half_edges.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

using Triangles = std::vector<std::array<uint32_t, 3>>;

struct Component {
  int64_t vertices = 0, edges = 0, triangles = 0;
  int64_t boundary_edges = 0, inconsistent_edges = 0, nonmanifold_edges = 0, nonmanifold_vertices = 0;
  double volume_world = 0;
  bool orientable = true;

  bool is_manifold() const { return nonmanifold_edges == 0 && nonmanifold_vertices == 0 && triangles > 0; }
};

/// Faces in sets that say of each whether it must be turned to agree with the first of them.
class Turns {
 public:
  explicit Turns(size_t count) : parent_(count), turned_(count) {
    for (size_t i = 0; i < count; ++i) parent_[i] = uint32_t(i);
  }
  /// False when the two are known to be related in the other way.
  bool relate(uint32_t a, uint32_t b, bool turned) {
    const auto [root_a, by_a] = find(a);
    const auto [root_b, by_b] = find(b);
    if (root_a == root_b) return (by_a != by_b) == turned;
    parent_[root_a] = root_b;
    turned_[root_a] = (by_a != by_b) != turned;
    return true;
  }

 private:
  struct Found {
    uint32_t root;
    bool turned;
  };
  Found find(uint32_t i) {
    Found found{i, false};
    while (parent_[found.root] != found.root) found = {parent_[found.root], found.turned != bool(turned_[found.root])};
    bool left = found.turned;
    while (parent_[i] != i) {  // all on the way point at the root from now on
      const uint32_t next = parent_[i];
      const bool here = turned_[i];
      parent_[i] = found.root;
      turned_[i] = left;
      left = left != here;
      i = next;
    }
    return found;
  }

  std::vector<uint32_t> parent_;
  std::vector<uint8_t> turned_;
};

class Counter {
 public:
  Counter(const TriangleMesh& mesh, const Triangles& triangles)
      : mesh_(mesh),
        triangles_(triangles),
        sides_(find_edge_sides(triangles, mesh.vertices.size())),
        joined_(int64_t(mesh.vertices.size())),
        fans_(int64_t(3 * triangles.size())),
        smooth_fans_(int64_t(3 * triangles.size())),
        at_(mesh.vertices.size()) {}

  EdgeCensus run(const WorldPoint& middle) {
    number_components();
    for_each_edge(sides_, [&](uint32_t a, uint32_t b, View<const EdgeSide> on_edge) { count_edge(a, b, on_edge); });
    if (found_.counts.inconsistent_edges > 0) find_orientable();
    sum_triangles(middle);
    count_vertices();
    found_.counts.boundary_loops = count_loops(smooth_fans_, boundary_, int64_t(3 * triangles_.size()));
    sum_components();
    finish_lengths();
    return found_;
  }

 private:
  struct AtVertex {
    uint32_t edges = 0, fans = 0;
    bool on_boundary = false, on_nonmanifold = false;
  };

  uint32_t corner(uint32_t half_edge) const { return triangles_[half_edge / 3][half_edge % 3]; }
  /// The corner of the half-edge's triangle that is at its smaller or larger end.
  uint32_t corner_at(uint32_t half_edge, uint32_t vertex) const {
    return corner(half_edge) == vertex ? half_edge : next_in_triangle(half_edge);
  }
  Component& component_of(uint32_t vertex) { return components_[component_[joined_.root(vertex)]]; }
  /// Of two triangles.
  bool is_inconsistent(View<const EdgeSide> on_edge) const {
    return corner(on_edge[0].half_edge) == corner(on_edge[1].half_edge);
  }

  void number_components() {
    std::vector<uint8_t> used(mesh_.vertices.size());
    for (const auto& t : triangles_) {
      joined_.unite(t[0], t[1]);
      joined_.unite(t[1], t[2]);
      for (const uint32_t v : t) used[v] = 1;
    }
    component_.resize(used.size());
    for (uint32_t v = 0; v < used.size(); ++v) {
      if (!used[v]) continue;
      if (joined_.root(v) == v) {  // the smallest of its component: it comes first
        component_[v] = uint32_t(components_.size());
        components_.push_back({});
      }
      ++component_of(v).vertices;
      ++found_.counts.referenced_vertices;
    }
  }

  void count_edge(uint32_t a, uint32_t b, View<const EdgeSide> on_edge) {
    const int64_t faces = on_edge.size;
    Component& component = component_of(a);
    ++component.edges;
    ++at_[a].edges;
    ++at_[b].edges;
    add_length(length(mesh_.vertices[b] - mesh_.vertices[a]));
    for (int64_t i = 1; i < faces; ++i)
      for (const uint32_t v : {a, b}) {
        const uint32_t first = corner_at(on_edge[0].half_edge, v), other = corner_at(on_edge[i].half_edge, v);
        fans_.unite(first, other);
        if (faces == 2) smooth_fans_.unite(first, other);
      }
    if (faces == 1) {
      ++component.boundary_edges;
      boundary_.push_back(on_edge[0].half_edge);
      at_[a].on_boundary = at_[b].on_boundary = true;
    } else if (faces > 2) {
      ++component.nonmanifold_edges;
      at_[a].on_nonmanifold = at_[b].on_nonmanifold = true;
    } else if (is_inconsistent(on_edge)) {
      ++component.inconsistent_edges;
      ++found_.counts.inconsistent_edges;
    }
  }

  void find_orientable() {
    Turns turns(triangles_.size());
    for_each_edge(sides_, [&](uint32_t a, uint32_t, View<const EdgeSide> on_edge) {
      if (on_edge.size != 2) return;
      const uint32_t face = on_edge[0].half_edge / 3, other = on_edge[1].half_edge / 3;
      if (!turns.relate(face, other, is_inconsistent(on_edge))) component_of(a).orientable = false;
    });
  }

  void sum_triangles(const WorldPoint& middle) {
    for (const auto& [a, b, c] : triangles_) {
      Component& component = component_of(a);
      ++component.triangles;
      const WorldPoint p = mesh_.vertices[a] - middle, q = mesh_.vertices[b] - middle, r = mesh_.vertices[c] - middle;
      component.volume_world += dot(p, cross(q, r)) / 6;
    }
  }

  void count_vertices() {
    for (uint32_t c = 0; c < 3 * triangles_.size(); ++c)
      if (fans_.root(c) == c) ++at_[corner(c)].fans;
    ValenceCounts& valence = found_.valence;
    valence.smallest = std::numeric_limits<int64_t>::max();
    int64_t irregular = 0, boundary_irregular = 0;
    for (uint32_t v = 0; v < at_.size(); ++v) {
      const AtVertex& at = at_[v];
      if (at.edges == 0) continue;
      if (at.fans > 1 || at.on_nonmanifold) {
        ++component_of(v).nonmanifold_vertices;
        if (!at.on_nonmanifold) ++found_.counts.bow_ties;
      }
      valence.smallest = std::min<int64_t>(valence.smallest, at.edges);
      valence.largest = std::max<int64_t>(valence.largest, at.edges);
      if (at.on_boundary) {
        ++valence.boundary;
        boundary_irregular += at.edges != 4;
      } else {
        ++valence.interior;
        irregular += at.edges != 6;
        ++valence.interior_with[std::min<size_t>(at.edges, valence.interior_with.size() - 1)];
      }
    }
    if (valence.largest == 0) valence.smallest = 0;
    const auto& with = valence.interior_with;
    if (valence.interior > 0) {
      valence.irregular_ratio = double(irregular) / double(valence.interior);
      valence.with_5_to_7_pct = 100 * double(with[5] + with[6] + with[7]) / double(valence.interior);
    }
    if (valence.boundary > 0) valence.boundary_irregular_ratio = double(boundary_irregular) / double(valence.boundary);
  }

  void sum_components() {
    ComplexCounts& all = found_.counts;
    all.components = int64_t(components_.size());
    for (const Component& c : components_) {
      all.edges += c.edges;
      all.boundary_edges += c.boundary_edges;
      all.nonmanifold_edges += c.nonmanifold_edges;
      all.nonmanifold_vertices += c.nonmanifold_vertices;
      all.volume_world += c.volume_world;
      all.nonorientable_components += !c.orientable;
      if (!c.is_manifold()) continue;
      if (c.boundary_edges > 0) {
        ++all.bordered_components;
        continue;
      }
      ++all.closed_components;
      if (c.orientable) all.genus += (2 - (c.vertices - c.edges + c.triangles)) / 2;
      all.inverted_components += c.inconsistent_edges == 0 && c.volume_world < 0;
    }
    all.euler = all.referenced_vertices - all.edges + int64_t(triangles_.size());
    all.closed_manifold = all.components > 0 && all.closed_components == all.components;
  }

  void add_length(double edge) {
    EdgeStatistics& lengths = found_.edges;
    if (length_count_ == 0) lengths.min = edge;
    ++length_count_;
    length_sum_ += edge;
    length_sum_sq_ += edge * edge;
    lengths.min = std::min(lengths.min, edge);
    lengths.max = std::max(lengths.max, edge);
  }
  void finish_lengths() {
    if (length_count_ == 0) return;
    EdgeStatistics& lengths = found_.edges;
    lengths.mean = length_sum_ / double(length_count_);
    lengths.deviation = std::sqrt(std::max(0.0, length_sum_sq_ / double(length_count_) - lengths.mean * lengths.mean));
  }

  const TriangleMesh& mesh_;
  const Triangles& triangles_;
  const EdgeSides sides_;
  IndexSets joined_;              ///< vertices, through edges
  IndexSets fans_, smooth_fans_;  ///< corners, around their vertex: through all edges, through those with two faces
  std::vector<AtVertex> at_;
  std::vector<uint32_t> component_;  ///< of the roots of joined_
  std::vector<Component> components_;
  std::vector<uint32_t> boundary_;  ///< half-edges
  int64_t length_count_ = 0;
  double length_sum_ = 0, length_sum_sq_ = 0;
  EdgeCensus found_;
};

}  // namespace

int64_t count_duplicates(std::vector<std::array<uint32_t, 3>> triangles) {
  for (auto& t : triangles) std::sort(t.begin(), t.end());
  tbb::parallel_sort(triangles.begin(), triangles.end());
  int64_t count = 0;
  for (size_t i = 1; i < triangles.size(); ++i) count += triangles[i] == triangles[i - 1];
  return count;
}

int64_t count_loops(IndexSets& fans, const std::vector<uint32_t>& boundary, int64_t half_edges) {
  if (boundary.empty()) return 0;
  IndexSets loops(half_edges);
  std::vector<uint32_t> ends;
  for (const uint32_t h : boundary) {
    const uint32_t from = fans.root(h), to = fans.root(next_in_triangle(h));
    loops.unite(from, to);
    ends.insert(ends.end(), {from, to});
  }
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return std::count_if(ends.begin(), ends.end(), [&](uint32_t e) { return loops.root(e) == e; });
}

EdgeCensus count_complex(const TriangleMesh& mesh, const WorldPoint& middle, int64_t dropped) {
  Triangles sound;
  const int64_t repeated = std::count_if(mesh.triangles.begin(), mesh.triangles.end(), repeats_corner);
  if (repeated > 0)
    std::copy_if(mesh.triangles.begin(), mesh.triangles.end(), std::back_inserter(sound),
                 [](const auto& t) { return !repeats_corner(t); });
  EdgeCensus census = Counter(mesh, repeated > 0 ? sound : mesh.triangles).run(middle);
  ComplexCounts& counts = census.counts;
  counts.vertices = int64_t(mesh.vertices.size());
  counts.triangles = int64_t(mesh.triangles.size()) + dropped;
  counts.repeated_corners = repeated + dropped;
  counts.duplicate_triangles = count_duplicates(mesh.triangles);
  counts.closed_manifold = counts.closed_manifold && counts.repeated_corners == 0;
  return census;
}

}  // namespace isoshell
