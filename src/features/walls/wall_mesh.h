// Patches of a cut surface as one mesh, changed edge by edge so that no triangles come to meet.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "features/angles/cut_lookup.h"
#include "features/mesh/editable_mesh.h"
#include "features/mesh/refine_mesh.h"
#include "features/walls/sheet_order.h"

namespace isoshell {

constexpr double kTwoRootThree =
    3.4641016151377544;  ///< sum of the squared edges of an equilateral triangle over twice its area

/// Triangles on vertices of a fine mesh: some of its own, or those that it was refined from, on its first vertices.
struct WallTriangles {
  const MeshTriangles& triangles;
  const std::vector<uint32_t>& source_face;  ///< per triangle, as in FineMesh
  size_t vertices;                           ///< of the fine mesh, that they are on
};

/// An EditableMesh whose triangles are kept apart. No split, and no collapse with Shapes::good, turns a triangle over
/// or makes a needle of it, unless it is short; flips and moves are made where they cost less. None turns a piece of a
/// region inside out.
class WallMesh : public EditableMesh {
 public:
  /// The fine mesh and `cut` must outlive it. Cost: O(fine triangles), and a sort of the edges of curves.
  WallMesh(const CutSurface& cut, const WallTriangles& walls);
  /// Of such a mesh, of many triangles, whose vertices are on the surface. Cost: O(triangles).
  WallMesh(std::shared_ptr<const CutLookup> lookup, EditableMesh mesh);

  const CutLookup& lookup() const { return *lookup_; }
  std::shared_ptr<const CutLookup> shared_lookup() const { return lookup_; }
  /// The length of edges that is aimed at, where lengths were asked for; 1 where edges are to be as long as each other.
  double aimed_at(uint32_t v) const;

  /// What triangles a collapse may make: no worse ones than said above, or any on the side of the surface that they
  /// were on.
  enum class Shapes { good, any };
  /// `short_square`: triangles whose squared edges are shorter, in terms of the length aimed at, go on being collapsed,
  /// and may be needles.
  bool collapse(uint32_t gone, uint32_t into, MeshChange& change, Shapes shapes = Shapes::good,
                double short_square = 0);
  bool split(uint32_t u, uint32_t v, const RegionVertex& middle, MeshChange& change);
  /// `cost_of_valence`: of the square by which the triangles of a vertex are more or fewer than those of a regular
  /// mesh, which lets flips pass where they cost a little.
  bool flip(uint32_t triangle, size_t edge, double cost_of_valence, MeshChange& change);
  bool move(uint32_t v, const RegionVertex& to, MeshChange& change);

 private:
  WallMesh(const std::shared_ptr<const CutLookup>& lookup, const WallTriangles& walls);

  /// 0 for an equilateral triangle that lies as the surface does, and more for others.
  double cost(const RegionTriangle& t) const;
  double cost_around(uint32_t v) const;
  double irregularity(uint32_t v, uint32_t patch, int more) const;
  bool is_sound(const RegionTriangle& t) const;
  bool may_replace(const RegionTriangle& made, const RegionTriangle& before, double short_sq_q8) const;

  std::shared_ptr<const CutLookup> lookup_;
  PatchLabels labels_;  ///< empty: the surface parts no regions
};

}  // namespace isoshell
