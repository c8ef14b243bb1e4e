// A few triangles of a result with curves, to be changed and measured on their own.
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <vector>

#include "features/angles/cut_lookup.h"
#include "geometry/world_vector.h"

namespace isoshell {

/// A vertex of the result, where it sits on the cut surface.
struct RegionVertex {
  enum class Kind : uint8_t { corner, on_curve, free };
  Kind kind = Kind::free;
  bool is_inner = true;      ///< all its triangles are in the region: what is not stays as it is
  WorldPoint position;       ///< whole steps of 1/256 voxel
  uint32_t home = 0;         ///< vertex of the surface; off the free ones a copy of their place
  uint32_t curve = 0;        ///< that a vertex is on, of CutSurface::curves
  size_t at = 0;             ///< its place on it
  uint32_t number = kNoOne;  ///< in the result; none of what was put in
  static constexpr uint32_t kNoOne = ~uint32_t(0);
};

struct RegionTriangle {
  std::array<uint32_t, 3> corner;
  std::array<uint32_t, 3> curve;  ///< that the edge from corner i to the next is on; kNone off curves
  uint32_t patch = 0;

  /// Taken out by a collapse; its place stays, so that the others keep theirs.
  bool is_gone() const { return corner[0] == corner[1]; }
};

/// Changes keep the topology, the patches and the curves; no edge comes to be there twice. A change that cannot be made
/// leaves the region as it was. Cost: a look at all corners each, and the cost of the triangles that it touches.
class MeshRegion {
 public:
  MeshRegion(const CutLookup& surface, std::vector<RegionVertex> vertices, std::vector<RegionTriangle> triangles);

  /// 0 where no angle is below 36 degrees and the triangles follow surface and curves; rises steeply below.
  double cost() const;
  /// Of the triangle between the first three vertices.
  double cost_of_first() const;
  /// Triangles with an angle below 30 degrees.
  int64_t poor() const;
  /// Of the smallest angle, or of 30 degrees where that is less.
  double worst_sine() const;
  /// Whether no angle is smaller than the smallest was, and no more triangles are poor, or all together much better.
  bool is_better_than(const MeshRegion& start) const;
  /// Puts a vertex, the last one then, into an edge, where that is nearest to a point.
  bool split(uint32_t u, uint32_t v, const WorldPoint& near);
  /// Takes a vertex into another one, along their edge: a free one, or one on a curve along that.
  bool collapse(uint32_t gone, uint32_t into);
  /// Flips edges and moves vertices of triangles that cost something, while that costs less. What did not help before
  /// is tried again only where something around it has changed since. Ends where the cost is `hopeless` after a round.
  void relax(double hopeless = std::numeric_limits<double>::infinity());
  /// The flips alone, which cost little and tell much of what is left to relax.
  void flip_edges();
  /// Lets relax leave alone what does not change from now on.
  void mark_all_tried();

  const std::vector<RegionVertex>& vertices() const { return vertices_; }
  const std::vector<RegionTriangle>& triangles() const { return triangles_; }
  /// Whether a triangle, or one that shares a corner with it, is not as it was put in.
  bool has_changed(size_t triangle) const;

 private:
  /// The edge from corner `edge` of a triangle to the next.
  struct Side {
    size_t triangle, edge;
  };
  double sine_of(const RegionTriangle& t) const;
  double cost_of(const RegionTriangle& t, double enough) const;
  double cosine_to_surface(const RegionTriangle& t) const;
  double cost_of_chord(uint32_t u, uint32_t v, uint32_t curve) const;
  std::array<size_t, 2> span(uint32_t u, uint32_t v, uint32_t curve) const;
  size_t place_on(const RegionVertex& v, uint32_t curve, size_t other) const;

  std::vector<size_t> triangles_of(uint32_t v) const;
  std::vector<Side> sides_of(uint32_t u, uint32_t v) const;
  std::optional<Side> side_from(uint32_t u, uint32_t v) const;
  std::vector<uint32_t> neighbours_of(uint32_t v) const;
  std::vector<uint32_t> next_on_curve(uint32_t v) const;
  void touch(const std::vector<uint32_t>& vertices);
  int changed_at(const RegionTriangle& t) const;

  RegionVertex vertex_between(uint32_t u, uint32_t v, uint32_t curve, uint32_t patch, const WorldPoint& near) const;
  RegionVertex vertex_near(uint32_t start, const WorldPoint& near) const;
  RegionVertex on_curve_at(uint32_t curve, size_t at) const;
  std::vector<RegionVertex> positions_around(uint32_t v) const;
  std::vector<RegionVertex> positions_along(uint32_t v) const;
  bool flip(size_t triangle, size_t edge);
  bool flip_any(size_t triangle);
  bool move(uint32_t v);

  const CutLookup* surface_;
  std::vector<RegionVertex> vertices_;
  std::vector<RegionTriangle> triangles_;
  std::vector<double> costs_;         ///< per triangle
  int clock_ = 0;                     ///< changes so far
  std::vector<int> changed_, tried_;  ///< per vertex when it or a neighbour changed last, and was to move
  std::vector<int> looked_at_;        ///< per triangle
  std::vector<int> flips_tried_;      ///< per triangle, when none of its edges was better flipped
  double follows_;                    ///< cosine between normals of triangles and surface, below which it costs
};

constexpr double kPoorSine = 0.5;  ///< of 30 degrees
constexpr double kMostCost = 1e6;  ///< of one triangle: a degenerate one
/// The sine of the smallest angle of a triangle.
double smallest_sine(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c);

}  // namespace isoshell
