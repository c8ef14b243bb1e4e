// How good the triangles of a mesh are: the measures of the paper's section 4.2 and a few more.
#pragma once

#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// A triangle and its smallest angle.
struct PoorAngle {
  double degrees = 0;
  int64_t triangle = -1;
  WorldPoint middle{0, 0, 0};  ///< of the triangle
};

/// The smallest angle that two triangles with a common edge have between them, 180 degrees where all are flat, and the
/// middle of that edge. Mesh generators that fill a surface take no angles near zero.
struct LeastDihedral {
  double degrees = 180;
  WorldPoint middle{0, 0, 0};
};

/// Result: the same for every number of threads; of equal angles that of the first edge. Triangles without area have
/// none. Cost: O(triangles), and a list of half-edges. Throws: usage when an index is out of range; out_of_memory for
/// more triangles than half-edges can be numbered of in 32 bits.
LeastDihedral find_least_dihedral(const TriangleMesh& mesh);

/// Zero for a mesh without triangles.
struct MeshQuality {
  double q_min = 0;  ///< Q = 6 / sqrt(3) * inradius / longest edge; 1 for the equilateral triangle
  double q_avg = 0;
  double theta_min_deg = 0;            ///< smallest angle of the mesh
  int64_t theta_min_at = -1;           ///< the first triangle that has it
  double theta_avg_deg = 0;            ///< mean over the triangles of their smallest angle
  double theta_max_deg = 0;            ///< largest angle of the mesh
  double below_30_deg_pct = 0;         ///< triangles whose smallest angle is below 30 degrees
  int64_t below_30_deg = 0;            ///< how many these are
  std::vector<PoorAngle> poor_angles;  ///< the worst of them, at most kMostPoorAngles
  static constexpr int64_t kMostPoorAngles = 8;
  LeastDihedral dihedral;
  double irregular_ratio = 0;  ///< vertices that not exactly six triangles share, of the vertices that have any
  double edge_cv = 0;          ///< standard deviation over mean of the edge lengths, each side of an edge counted
  double area_cv = 0;          ///< of the triangle areas
};

/// Result: sums run in one fixed shape, so threads do not matter. Cost: one pass, and a list of half-edges.
/// Throws: usage when an index is out of range.
MeshQuality measure_quality(const TriangleMesh& mesh);

}  // namespace isoshell
