// flip_flat_edges (see flip_flat_edges.h).
#include "features/mesh/flip_flat_edges.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>

#include "core/parallel_ranges.h"
#include "features/mesh/edge_subdivision.h"
#include "features/mesh/twin_triangles.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kMostOffPlaneQ8 = 0.5;
constexpr size_t kMostFlipsPerEdge = 256;  ///< strips take dozens; rounding may not make it endless
constexpr double kRoundedAway = 1e-9;      ///< sums of two angles of 180 degrees, as in grids, are not told from it

class FlatEdges : private TwinTriangles {
 public:
  /// `twins` are those between paths: edges without stay, and of no flip more than a part is seen or changed. No edge
  /// is made that `avoided` has, which is ascending.
  FlatEdges(FineMesh& mesh, MeshTwins& twins, const std::vector<uint64_t>& avoided)
      : TwinTriangles(mesh.triangles, twins.of), mesh_(mesh), part_(twins.part), avoided_(avoided) {}

  /// Returns the edges that flips made, whether they still are or not.
  std::vector<uint64_t> flip_all() {
    std::vector<uint8_t> is_waiting(twin_.size(), 0);
    for_each_index(uint32_t(0), uint32_t(twin_.size()), [&](uint32_t h) {
      if (twin_[h] == kNone || twin_[h] < h || is_acute(h)) return;
      const uint32_t c = canonical(h);
      is_waiting[c] = should_flip(c);
    });
    std::vector<Waiting> waiting;
    for (uint32_t h = 0; h < is_waiting.size(); ++h)
      if (is_waiting[h]) waiting.push_back({part_[h / 3], h, at(from(h)), at(to(h))});
    tbb::parallel_sort(waiting.begin(), waiting.end());
    std::vector<std::vector<uint32_t>> of_part;
    for (size_t i = 0; i < waiting.size(); ++i) {
      if (i == 0 || waiting[i].part != waiting[i - 1].part) of_part.emplace_back();
      of_part.back().push_back(waiting[i].half_edge);
    }
    std::vector<std::vector<uint64_t>> made_in(of_part.size());
    for_each_index(size_t(0), of_part.size(), [&](size_t p) { made_in[p] = flip_waiting(std::move(of_part[p])); });
    std::vector<uint64_t> made;
    for (const std::vector<uint64_t>& in_part : made_in) made.insert(made.end(), in_part.begin(), in_part.end());
    return made;
  }

 private:
  /// In an order that does not depend on how triangles are numbered, but where edges have the same ends.
  struct Waiting {
    uint32_t part, half_edge;
    WorldPoint from, to;

    bool operator<(const Waiting& o) const {
      if (part != o.part) return part < o.part;
      if (is_before(from, o.from)) return true;
      if (is_before(o.from, from)) return false;
      if (is_before(to, o.to)) return true;
      return !is_before(o.to, to) && half_edge < o.half_edge;
    }
  };

  std::vector<uint64_t> flip_waiting(std::vector<uint32_t> waiting) {
    std::vector<uint64_t> made;
    for (size_t left = kMostFlipsPerEdge * twin_.size(); !waiting.empty() && left > 0; --left) {
      uint32_t h = waiting.back();
      waiting.pop_back();
      if (twin_[h] == kNone || is_acute(h)) continue;
      h = canonical(h);
      if (!should_flip(h)) continue;
      const uint32_t t = h - h % 3, u = twin_[h] - twin_[h] % 3;
      made.push_back(edge_key(opposite(h), opposite(twin_[h])));
      flip(h);
      waiting.insert(waiting.end(), {t, t + 2, u, u + 2});
    }
    return made;
  }

  const WorldPoint& at(uint32_t v) const { return mesh_.position[v]; }
  uint32_t canonical(uint32_t h) const { return is_before(at(from(h)), at(to(h))) ? h : twin_[h]; }

  /// Whether neither of the angles at c and d is more than 90 degrees, so that the edge should not flip.
  bool is_acute(uint32_t h) const {
    const WorldPoint &a = at(from(h)), &b = at(to(h)), &c = at(opposite(h)), &d = at(opposite(twin_[h]));
    return dot(a - c, b - c) >= 0 && dot(a - d, b - d) >= 0;
  }

  /// Whether the angles at c and d are more than 180 degrees together, and the edge between them would do as well and
  /// be the only one.
  bool should_flip(uint32_t h) const {
    const WorldPoint &a = at(from(h)), &b = at(to(h)), &c = at(opposite(h)), &d = at(opposite(twin_[h]));
    const WorldPoint at_c = cross(b - a, c - a), at_d = cross(a - b, d - b);
    const double area_c = length(at_c), area_d = length(at_d);
    const double left = dot(a - c, b - c) * area_d, right = dot(a - d, b - d) * area_c;
    if (left + right >= -kRoundedAway * (std::abs(left) + std::abs(right))) return false;
    if (!are_in_plane(a, b, c, d)) return false;
    const WorldPoint both = at_c + at_d;
    if (dot(cross(d - a, c - a), both) <= 0 || dot(cross(c - b, d - b), both) <= 0) return false;
    const double longest_sq =
        std::max({length_sq(b - a), length_sq(c - a), length_sq(c - b), length_sq(d - a), length_sq(d - b)});
    return length(d - c) <= std::sqrt(longest_sq) && !is_beside(before(h), opposite(twin_[h])) &&
           !std::binary_search(avoided_.begin(), avoided_.end(), edge_key(opposite(h), opposite(twin_[h])));
  }

  /// Whether an edge joins the vertex that a half-edge begins at to another one, in the fan of its triangle.
  bool is_beside(uint32_t begin, uint32_t other) const {
    bool is_found = false;
    visit_fan(begin, [&](uint32_t h) {
      is_found = to(h) == other || opposite(h) == other;
      return !is_found;
    });
    return is_found;
  }

  const FineMesh& mesh_;
  const std::vector<uint32_t>& part_;
  const std::vector<uint64_t>& avoided_;
};

int64_t triangles_at(const EdgeSides& sides, uint64_t edge) {
  const View<const EdgeSide> from = sides.in(int64_t(edge >> 32));
  return std::count_if(from.begin(), from.end(), [&](const EdgeSide& s) { return s.larger_end == uint32_t(edge); });
}

/// Those of the edges that flips made which have more than two triangles now and had not: others had them, too, or they
/// were made twice.
std::vector<uint64_t> crowded_of(const EdgeSides& before, const FineMesh& mesh, std::vector<uint64_t> made) {
  tbb::parallel_sort(made.begin(), made.end());
  std::vector<uint64_t> crowded;
  for (size_t i = 0; i < made.size(); ++i)
    if ((i > 0 && made[i] == made[i - 1]) || triangles_at(before, made[i]) > 0) crowded.push_back(made[i]);
  if (crowded.empty()) return crowded;
  const EdgeSides now = find_edge_sides(mesh.triangles, mesh.position.size());
  const auto are_few = [&](uint64_t edge) { return triangles_at(now, edge) <= 2 || triangles_at(before, edge) > 2; };
  crowded.erase(std::remove_if(crowded.begin(), crowded.end(), are_few), crowded.end());
  return crowded;
}

}  // namespace

bool are_in_plane(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c, const WorldPoint& d) {
  const WorldPoint ab = b - a, at_c = cross(ab, c - a), at_d = cross(d - a, ab), both = at_c + at_d;
  if (std::abs(dot(at_c, d - a)) > kMostOffPlaneQ8 * length(both)) return false;
  const auto faces_so = [&](const WorldPoint& n) {
    return dot(n, both) > 0 || length(n) <= kMostOffPlaneQ8 * length(ab);
  };
  return faces_so(at_c) && faces_so(at_d);
}

FineMesh flip_flat_edges(FineMesh mesh, MeshTwins* twins) {
  const MeshTriangles before = mesh.triangles;
  const EdgeSides sides = find_edge_sides(before, mesh.position.size());
  const std::vector<uint64_t> on_paths = path_edges(mesh.paths);
  std::vector<uint64_t> avoided;  // what both sides of a thin part would make
  for (;;) {
    MeshTwins found = find_twins(before, sides, on_paths);
    const std::vector<uint64_t> made = FlatEdges(mesh, found, avoided).flip_all();
    const std::vector<uint64_t> crowded = crowded_of(sides, mesh, made);
    if (crowded.empty()) {
      if (twins) *twins = std::move(found);
      return mesh;
    }
    avoided.insert(avoided.end(), crowded.begin(), crowded.end());
    std::sort(avoided.begin(), avoided.end());
    mesh.triangles = before;
  }
}

}  // namespace isoshell
