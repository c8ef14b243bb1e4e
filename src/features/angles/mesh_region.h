// A few triangles of a result with curves, to be changed and measured on their own.
#pragma once

#include <array>
#include <limits>
#include <vector>

#include "features/angles/cut_lookup.h"
#include "features/mesh/editable_mesh.h"

namespace isoshell {

/// Changes keep what those of an EditableMesh keep, and do not ask whether triangles come to meet. Cost: a look at all
/// corners each, and the cost of the triangles that it touches.
class MeshRegion : public EditableMesh {
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
  bool collapse(uint32_t gone, uint32_t into);
  /// Flips edges and moves vertices of triangles that cost something, while that costs less. What did not help before
  /// is tried again only where something around it has changed since. Ends where the cost is `hopeless` after a round.
  void relax(double hopeless = std::numeric_limits<double>::infinity());
  /// The flips alone, which cost little and tell much of what is left to relax.
  void flip_edges();
  /// Lets relax leave alone what does not change from now on.
  void mark_all_tried();
  /// Whether a triangle, or one that shares a corner with it, is not as it was put in.
  bool has_changed(size_t triangle) const;

 private:
  double cost_of(const RegionTriangle& t, double enough) const;
  double cost_of_chord(uint32_t u, uint32_t v, uint32_t curve) const;
  std::array<size_t, 2> span(uint32_t u, uint32_t v, uint32_t curve) const;
  size_t place_on(const RegionVertex& v, uint32_t curve, size_t other) const;

  std::vector<uint32_t> triangles_of(uint32_t v) const;
  void cost_again(const std::vector<uint32_t>& triangles);
  void note(const std::vector<RegionTriangle>& changed);
  int changed_at(const RegionTriangle& t) const;

  RegionVertex vertex_between(uint32_t u, uint32_t v, uint32_t curve, uint32_t patch, const WorldPoint& near) const;
  std::vector<RegionVertex> positions_around(uint32_t v) const;
  std::vector<RegionVertex> positions_along(uint32_t v) const;
  bool flip(uint32_t triangle, size_t edge, MeshChange& change);
  bool flip_any(uint32_t triangle, MeshChange& change);
  bool move(uint32_t v, MeshChange& change);

  const CutLookup* surface_;
  std::vector<double> costs_;         ///< per triangle
  int clock_ = 0;                     ///< changes so far
  std::vector<int> changed_, tried_;  ///< per vertex when it or a neighbour changed last, and was to move
  std::vector<int> looked_at_;        ///< per triangle
  std::vector<int> flips_tried_;      ///< per triangle, when none of its edges was better flipped
  double follows_;                    ///< cosine between normals of triangles and surface, below which it costs
};

}  // namespace isoshell
