// Patches of a cut surface as one mesh, changed edge by edge so that no triangles come to meet.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "features/angles/cut_lookup.h"
#include "features/angles/mesh_region.h"
#include "features/mesh/refine_mesh.h"
#include "measure/triangle_space.h"

namespace isoshell {

constexpr double kTwoRootThree =
    3.4641016151377544;  ///< sum of the squared edges of an equilateral triangle over twice its area

/// Triangles on vertices of a fine mesh: some of its own, or those that it was refined from, on its first vertices.
struct WallTriangles {
  const MeshTriangles& triangles;
  const std::vector<uint32_t>& source_face;  ///< per triangle, as in FineMesh
  size_t vertices;                           ///< of the fine mesh, that they are on
};

/// What changes of a WallMesh take memory for: kept, so that they do not take it each time.
struct WallScratch {
  std::vector<uint32_t> here, there, replaced, number;
  std::vector<RegionTriangle> made;
  std::vector<CornersOfTriangle> corners;
  std::vector<std::pair<uint32_t, uint32_t>> fused;  ///< ends of edges of which one was on a curve, and that
};

/// A change keeps the topology of every region, the patches and the curves. One that would not, or after
/// which a triangle met another one outside of corners that they share, is not made; no split, and no
/// collapse with Shapes::good, turns a triangle over or makes a needle of it. Vertices and triangles keep their
/// numbers; those that are gone have no triangles, and one corner twice. Cost of each: the triangles around its
/// vertices, and a look at those whose boxes meet them. Several threads may make changes at once, each with its own
/// scratch, but for splits, where the triangles around their vertices, before and after, lie in boxes that do not meet.
class WallMesh {
 public:
  /// The fine mesh and `cut` must outlive it. Cost: O(fine triangles), and a sort of the edges of curves.
  WallMesh(const CutSurface& cut, const WallTriangles& walls);

  const CutLookup& lookup() const { return *lookup_; }
  int64_t vertex_count() const { return count_; }
  const std::vector<RegionVertex>& vertices() const { return vertices_; }
  const std::vector<RegionTriangle>& triangles() const { return triangles_; }
  const RegionVertex& vertex(uint32_t v) const { return vertices_[v]; }
  const WorldPoint& at(uint32_t v) const { return vertices_[v].position; }
  const std::vector<uint32_t>& around(uint32_t v) const { return around_[v]; }

  /// No change makes one of these triangles from now on, nor an edge of theirs but where it is on the same curve. Their
  /// corners are vertices, or numbers that no vertex has.
  void avoid_twins_of(const std::vector<RegionTriangle>& others);
  /// No change lets a triangle come to meet one of these from now on.
  void avoid(const std::vector<CornersOfTriangle>& others);
  /// Calls use(i) for each of those to avoid that a triangle meets.
  template <class Use>
  void for_each_met(const RegionTriangle& t, Use use) const {
    others_->for_each_met(corners(t), use);
  }
  /// A vertex stays where it is from now on, and so do edges on curves between two that stay.
  void keep(uint32_t v);

  /// The length of edges that is aimed at, where lengths were asked for; 1 where edges are to be as long as each other.
  double aimed_at(uint32_t v) const;
  void list_neighbours(uint32_t v, std::vector<uint32_t>& out) const;
  /// Those that a vertex may be taken into, as far as its curve tells: of a corner none.
  void list_targets(uint32_t v, std::vector<uint32_t>& out) const;
  /// The curve of the edge between two vertices, kNone off curves; no value where there is no edge.
  std::optional<uint32_t> curve_between(uint32_t u, uint32_t v) const;

  /// What triangles a collapse may make: no worse ones than said above, or any on the side of the surface that they
  /// were on.
  enum class Shapes { good, any };
  /// Whether the change was made, here and below.
  bool collapse(uint32_t gone, uint32_t into, WallScratch& scratch, Shapes shapes = Shapes::good);
  /// Puts a vertex, the last one then, into an edge.
  bool split(uint32_t u, uint32_t v, const RegionVertex& middle, WallScratch& scratch);
  /// Where that costs less. `cost_of_valence`: of the square by which the triangles of a vertex are more or fewer than
  /// those of a regular mesh, which lets flips pass where they cost a little.
  bool flip(uint32_t triangle, size_t edge, double cost_of_valence, WallScratch& scratch);
  /// Along its curve, or in its patch, where that costs less.
  bool move(uint32_t v, const RegionVertex& to, WallScratch& scratch);

 private:
  struct Side {
    uint32_t triangle;
    size_t edge;
  };
  using Edges = std::vector<std::pair<uint64_t, uint32_t>>;  ///< keys, and what they are on

  void list_vertices(size_t count);
  void list_curve(uint32_t number, const CurvePath& path, Edges& edges);
  void list_triangles(const WallTriangles& walls, const Edges& on_curve);
  std::vector<Side> sides_of(uint32_t u, uint32_t v) const;

  /// 0 for an equilateral triangle that lies as the surface does, and more for others.
  double cost(const RegionTriangle& t) const;
  double cost_around(uint32_t v) const;
  double irregularity(uint32_t v, uint32_t patch, int more) const;
  double cosine_to_surface(const RegionTriangle& t) const;
  WorldPoint normal(const RegionTriangle& t) const;
  double sine(const RegionTriangle& t) const;
  bool is_kept(uint32_t v) const { return v < is_kept_.size() && is_kept_[v]; }
  bool is_sound(const RegionTriangle& t) const;
  bool is_of_others(uint32_t u, uint32_t v, uint32_t curve) const;
  bool may_replace(const RegionTriangle& made, const RegionTriangle& before) const;
  bool may_collapse(uint32_t gone, uint32_t into, const std::vector<Side>& sides, WallScratch& scratch) const;
  CornersOfTriangle corners(const RegionTriangle& t) const;
  bool are_free(WallScratch& scratch) const;
  void replace(uint32_t triangle, const RegionTriangle& by);

  std::shared_ptr<const CutLookup> lookup_;
  std::vector<RegionVertex> vertices_;
  std::vector<RegionTriangle> triangles_;
  std::vector<std::vector<uint32_t>> around_;  ///< per vertex its triangles
  TriangleSpace space_;
  std::vector<char> is_kept_;                   ///< per vertex; those beyond its end are not
  std::vector<std::array<uint32_t, 3>> twins_;  ///< corners of triangles that are not to be made, all ascending
  Edges others_edges_;                          ///< of these, ascending
  std::optional<TriangleSpace> others_;         ///< that are to be avoided
  std::atomic<int64_t> count_{0};
};

}  // namespace isoshell
