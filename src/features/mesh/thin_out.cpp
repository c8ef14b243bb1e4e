// See thin_out.h.
#include "features/mesh/thin_out.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/buckets.h"
#include "core/watched.h"
#include "features/mesh/collapsing_mesh.h"
#include "features/mesh/lattice_cubes.h"
#include "geometry/box.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/advanced/voxel_set.h"
#include "measure/triangle_space.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

// In edges of the result.
constexpr double kLongestOnCurve = 0.15;          ///< places are what vertices of curves move to
constexpr double kCellOfSpace = 0.2;              ///< between the edges that there are and those that are left
constexpr double kCell = 8;                       ///< vertices of one task are in a cube of that size
constexpr double kLeastCosine = 0.8;              ///< between normals of a triangle before and after
constexpr double kLeastOfWalls = 0.5;             ///< between that of a triangle and those of the walls at its corners
constexpr double kOffsets[] = {0, .5, .25, .75};  ///< of the cubes: vertices at the sides of some are inside of others
constexpr uint32_t kOffCurves = kNone;
constexpr uint32_t kStays = kNone - 1;  ///< a corner, or what is no surface and no curve either

/// The triangles of walls while their vertices become fewer.
class ThinnedWalls : public CollapsingMesh<ThinnedWalls, double> {
 public:
  /// A patch between curves with fewer vertices inside than `fewest` stays as it is.
  ThinnedWalls(FeatureMesh mesh, const KeptInWalls& kept, const LatticeFrame& frame, double edge_world, uint32_t fewest)
      : CollapsingMesh(std::move(mesh.triangles), mesh.vertices.size()),
        mesh_(std::move(mesh)),
        edge_world_(edge_world),
        edge_q8_(edge_world / frame.voxel_size * kOneVoxelQ8),
        place_(vertices()),
        curve_(vertices(), kOffCurves),
        normal_(vertices()) {
    for_each_index(uint32_t(0), vertices(), [&](uint32_t v) {
      normal_[v] = normal_at(v);
      place_[v] = frame.snap(mesh_.vertices[v]);
    });
    find_curves(kept.creases);
    for (const uint32_t v : kept.vertices) curve_[v] = kStays;
    keep_small_patches(fewest);
  }

  void run(const Context& context) {
    for (const double offset : kOffsets) thin(offset, context);
  }

  /// Vertices and triangles in their order.
  FeatureMesh left() {
    std::vector<uint32_t> number(vertices(), kNone);
    uint32_t count = 0;
    for (uint32_t v = 0; v < vertices(); ++v)
      if (is_there(v)) mesh_.vertices[count] = mesh_.vertices[v], number[v] = count++;
    mesh_.vertices.resize(count);
    std::vector<std::pair<std::array<uint32_t, 3>, uint32_t>> triangles;
    for (size_t t = 0; t < triangles_.size(); ++t) {
      std::array<uint32_t, 3> c = triangles_[t];
      if (c[0] == kNone) continue;
      for (uint32_t& v : c) v = number[v];
      std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
      triangles.push_back({c, mesh_.source_face[t]});
    }
    std::sort(triangles.begin(), triangles.end());
    FeatureMesh out;
    out.vertices = {mesh_.vertices.begin(), mesh_.vertices.end()};
    out.rounding_world = mesh_.rounding_world;
    for (const auto& [c, face] : triangles) {
      out.triangles.push_back(c);
      out.source_face.push_back(face);
    }
    return out;
  }

 private:
  friend CollapsingMesh;
  static constexpr double kLongest = 0.4;

  struct CubeScratch : Scratch {
    CubeScratch(const Cubes& of, int64_t in, View<const uint32_t> all, double cell_q8)
        : cubes(of), cube(in), triangles(all), space(cell_q8, size_t(all.size)) {}

    const Cubes& cubes;
    int64_t cube;
    View<const uint32_t> triangles;  ///< whose boxes meet the cube, ascending
    TriangleSpace space;             ///< of these, by their places in that list
    std::vector<CornersOfTriangle> made;
    std::vector<uint32_t> replaced, number;
  };

  const WorldPoint& at(uint32_t v) const { return mesh_.vertices[v]; }
  double distance_sq(uint32_t u, uint32_t v) const { return isoshell::distance_sq(at(u), at(v)); }
  double square_of(double edges, uint32_t) const { return edges * edges * edge_world_ * edge_world_; }
  bool is_on_curve(uint32_t v) const { return curve_[v] != kOffCurves && curve_[v] != kStays; }
  /// Small walls keep some vertices inside so.
  bool may_take(uint32_t v) const { return curve_[v] == kOffCurves; }

  WorldPoint area_of(uint32_t c, uint32_t v) const {
    const uint32_t a = next_in_triangle(c);
    return doubled_area(at(v), at(corner(a)), at(corner(next_in_triangle(a))));
  }
  Normal8 normal_at(uint32_t v) const {
    WorldPoint sum{0, 0, 0};
    for_each_corner(v, [&](uint32_t c) { sum = sum + area_of(c, v); });
    const WorldPoint n = 127 * normalised(sum);
    const auto whole = [](double x) { return int8_t(std::floor(x + 0.5)); };
    return {whole(n.x), whole(n.y), whole(n.z)};
  }

  /// Curves are along creases, and edges that have not two triangles which pass them in opposite directions. They pass
  /// vertices where two such edges, of as many triangles, meet.
  void find_curves(const EdgeList& creases) {
    using OnCurve = std::pair<uint32_t, int64_t>;  // the other end of an edge, and how many triangles are there
    std::vector<std::pair<uint32_t, OnCurve>> found;
    for_each_edge(find_edge_sides(triangles_, vertices()), [&](uint32_t u, uint32_t v, View<const EdgeSide> sides) {
      const auto begins_at_u = [&](const EdgeSide& s) { return corner(s.half_edge) == u; };
      const bool is_inner = sides.size == 2 && begins_at_u(sides[0]) != begins_at_u(sides[1]);
      if (is_inner && !std::binary_search(creases.begin(), creases.end(), std::array{u, v})) return;
      found.insert(found.end(), {{u, {v, sides.size}}, {v, {u, sides.size}}});
    });
    const auto at = sort_into_buckets<OnCurve>(int64_t(vertices()), int64_t(found.size()), [&](int64_t i, auto put) {
      put(found[size_t(i)].first, found[size_t(i)].second);
    });
    for (uint32_t v = 0; v < vertices(); ++v) {
      const View<const OnCurve> edges = at.in(v);
      if (edges.size == 0) continue;
      const bool is_inside = edges.size == 2 && edges[0].second == edges[1].second;
      curve_[v] = is_inside ? uint32_t(beside_.size()) : kStays;
      if (is_inside) beside_.push_back({edges[0].first, edges[1].first});
    }
  }

  /// Per vertex off curves, how many there are in its patch.
  std::vector<uint32_t> sizes_of_patches() const {
    std::vector<uint32_t> parent(vertices()), count(vertices(), 0);
    const View<uint32_t> sets{parent.data(), int64_t(parent.size())};
    for_each_index(uint32_t(0), vertices(), StartAlone{sets});
    for_each_index(size_t(0), triangles_.size(), [&](size_t t) {
      const auto& c = triangles_[t];
      for (size_t i = 0; i < 3; ++i)
        if (curve_[c[i]] == kOffCurves && curve_[c[(i + 1) % 3]] == kOffCurves) join(sets, c[i], c[(i + 1) % 3]);
    });
    for_each_index(uint32_t(0), vertices(), PointAtRoot{sets});
    for (uint32_t v = 0; v < vertices(); ++v) count[parent[v]] += curve_[v] == kOffCurves ? 1 : 0;
    for (uint32_t v = 0; v < vertices(); ++v) parent[v] = count[parent[v]];
    return parent;
  }
  /// With the curves around them: where a result needs edges shorter than elsewhere, they must find vertices.
  void keep_small_patches(uint32_t fewest) {
    const std::vector<uint32_t> size = sizes_of_patches();
    std::vector<char> is_kept(vertices(), 0);
    for (const auto& t : triangles_) {
      const bool is_small =
          std::all_of(t.begin(), t.end(), [&](uint32_t v) { return curve_[v] != kOffCurves || size[v] < fewest; });
      if (is_small) is_kept[t[0]] = is_kept[t[1]] = is_kept[t[2]] = 1;
    }
    for (uint32_t v = 0; v < vertices(); ++v)
      if (is_kept[v]) curve_[v] = kStays;
  }

  /// Whether the triangle of a corner, once that is another vertex, is not between neighbours of that which share it
  /// already, and faces as it did, and as the walls do at its corners.
  bool fits(uint32_t c, uint32_t into, const Ring& beside) const {
    const uint32_t a = next_in_triangle(c), b = next_in_triangle(a);
    const uint32_t corners[3] = {into, corner(a), corner(b)};
    const auto is_beside = [&](uint32_t v) { return std::binary_search(beside.begin(), beside.end(), v); };
    if (is_beside(corners[1]) && is_beside(corners[2])) return false;
    const WorldPoint n = area_of(c, into);
    const auto is_along = [&](const WorldPoint& m, double least) {
      const double along = dot(n, m);
      return along > 0 && along * along >= least * least * length_sq(n) * length_sq(m);
    };
    return is_along(area_of(c, corner(c)), kLeastCosine) && std::all_of(corners, corners + 3, [&](uint32_t v) {
             const Normal8 m = normal_[v];
             return curve_[v] != kOffCurves || is_along({double(m.x), double(m.y), double(m.z)}, kLeastOfWalls);
           });
  }

  CornersOfTriangle corners(const std::array<uint32_t, 3>& t) const {
    return {{t[0], t[1], t[2]}, {place_[t[0]], place_[t[1]], place_[t[2]]}};
  }
  /// Lists what the triangles of a vertex are, and what becomes of them. Result: whether that meets nothing.
  bool is_free(uint32_t v, uint32_t into, CubeScratch& s) const {
    s.made.clear(), s.replaced.clear(), s.number.clear();
    for_each_corner(v, [&](uint32_t c) {
      std::array<uint32_t, 3> t = triangles_[c / 3];
      s.replaced.push_back(
          uint32_t(std::lower_bound(s.triangles.begin(), s.triangles.end(), c / 3) - s.triangles.begin()));
      if (std::find(t.begin(), t.end(), into) != t.end()) return;
      t[c % 3] = into;
      s.made.push_back(corners(t));
      s.number.push_back(s.replaced.back());
    });
    return s.space.are_free(s.made, s.replaced);
  }

  bool go(uint32_t v, uint32_t into, CubeScratch& s) {
    if (!is_free(v, into, s)) return false;
    for (const uint32_t t : s.replaced) s.space.take(t);
    for (size_t i = 0; i < s.made.size(); ++i) s.space.put(s.number[i], s.made[i]);
    take_into(v, s.ring, into);
    if (!is_on_curve(v)) return true;
    const uint32_t other = other_beside(v, into);
    if (is_on_curve(into)) replace_beside(into, v, other);
    if (is_on_curve(other)) replace_beside(other, v, into);
    return true;
  }

  uint32_t other_beside(uint32_t v, uint32_t u) const {
    const auto& [a, b] = beside_[curve_[v]];
    return a == u ? b : a;
  }
  void replace_beside(uint32_t v, uint32_t from, uint32_t to) {
    auto& [a, b] = beside_[curve_[v]];
    (a == from ? a : b) = to;
  }

  /// In each cube by itself: a vertex whose neighbours are not all in its cube stays, so that no task sees what another
  /// one does.
  void thin(double offset, const Context& context) {
    const Cubes cubes(place_, kCell * edge_q8_, offset);
    const auto vertices_in = sort_into_buckets<uint32_t>(cubes.count(), int64_t(vertices()), [&](int64_t v, auto put) {
      const auto i = size_t(v);
      if (is_there(uint32_t(v)) && curve_[i] != kStays) put(cubes.of(place_[i]), uint32_t(v));
    });
    const auto triangles_in =
        sort_into_buckets<uint32_t>(cubes.count(), int64_t(triangles_.size()), [&](int64_t t, auto put) {
          const auto& c = triangles_[size_t(t)];
          if (c[0] != kNone)
            cubes.for_each_meeting(box_of(place_[c[0]], place_[c[1]], place_[c[2]]),
                                   [&](int64_t cube) { put(cube, uint32_t(t)); });
        });
    for_each_index(int64_t(0), cubes.count(), [&](int64_t cube) {
      check_cancel(context, "features");
      const View<const uint32_t> here = vertices_in.in(cube);
      if (std::any_of(here.begin(), here.end(), [&](uint32_t v) { return may_change_[v] != 0; }))
        thin_cube(here, {cubes, cube, triangles_in.in(cube), kCellOfSpace * edge_q8_});
    });
  }

  /// In sweeps, in which none of two neighbours goes, so that what is left is even.
  void thin_cube(View<const uint32_t> vertices, CubeScratch s) {
    for (int64_t i = 0; i < s.triangles.size; ++i) s.space.put(uint32_t(i), corners(triangles_[s.triangles[i]]));
    bool has_changed = true;
    for (int sweep = 0; sweep < kMostSweeps && has_changed; ++sweep) {
      has_changed = false;
      for (const uint32_t v : vertices) stays_[v] = 0;
      for (const uint32_t v : vertices) {
        if (stays_[v] || !may_change_[v] || !is_there(v)) continue;
        find_ring(v, s.ring);
        if (!std::all_of(s.ring.begin(), s.ring.end(), [&](uint32_t w) { return s.cubes.of(place_[w]) == s.cube; }))
          continue;
        may_change_[v] = 0;
        if (is_on_curve(v) ? thin_on_curve(v, s) : thin_inside(v, s)) has_changed = true;
      }
    }
  }

  bool thin_on_curve(uint32_t v, CubeScratch& s) {
    const auto [before, after] = beside_[curve_[v]];
    if (before == after || distance_sq(before, after) > square_of(kLongestOnCurve, v)) return false;
    for (const uint32_t into : {before, after}) {
      find_ring(into, s.other);
      if (std::binary_search(s.other.begin(), s.other.end(), other_beside(v, into))) continue;
      if (may_go(v, s.ring, into, s.other) && go(v, into, s)) return true;
    }
    return false;
  }

  FeatureMesh mesh_;  ///< but its triangles
  double edge_world_, edge_q8_;
  std::vector<PointQ8> place_;   ///< per vertex, on the lattice of the run
  std::vector<uint32_t> curve_;  ///< per vertex on a curve its number in beside_
  std::vector<std::array<uint32_t, 2>> beside_;
  std::vector<Normal8> normal_;  ///< per vertex that of the walls there
};

}  // namespace

FeatureMesh thin_out(FeatureMesh mesh, const KeptInWalls& kept, const LatticeFrame& frame, double edge_world,
                     uint32_t fewest, const Context& context) {
  if (mesh.triangles.empty()) return mesh;
  return run_with_threads(context, [&] {
    ThinnedWalls thinned(std::move(mesh), kept, frame, edge_world, fewest);
    thinned.run(context);
    return thinned.left();
  });
}

}  // namespace isoshell
