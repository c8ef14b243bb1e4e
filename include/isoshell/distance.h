// How far a mesh is from another one, both ways, or from points.
#pragma once

#include <optional>
#include <vector>

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/backend.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Of points of one mesh to the nearest points of the other one, world units.
struct OneSidedDistance {
  double mean = 0, rms = 0;  ///< of the area samples
  double max = 0;  ///< of the area samples and the vertices: the true one is not below, and may lie between them
  std::optional<double> at_most;  ///< of all points, where it was asked for: the true largest one is not above
};
/// Between the normals at area samples of one mesh and those of the other one there, in degrees; 0 to 90, since it does
/// not matter which way triangles face.
struct NormalDeviation {
  double mean_deg = 0, max_deg = 0;
};
struct MeshDistance {
  OneSidedDistance to_reference, from_reference;
  double diagonal = 0;  ///< of the reference's bounding box
  NormalDeviation normal_to_reference, normal_from_reference;
  bool is_one_way = false;  ///< the reference is points: all but the distance from it is not measured

  /// The Hausdorff distance, as far as the samples show it.
  double largest() const { return to_reference.max > from_reference.max ? to_reference.max : from_reference.max; }
  /// The larger of both mean deviations of the normals.
  double normal_deviation_deg() const {
    return normal_to_reference.mean_deg > normal_from_reference.mean_deg ? normal_to_reference.mean_deg
                                                                         : normal_from_reference.mean_deg;
  }
};

constexpr int64_t kDistanceSamples = 50000;   ///< of each mesh
constexpr int64_t kDistanceVertices = 50000;  ///< most vertices of each mesh that are looked at

/// How closely it is looked at.
struct DistanceOptions {
  int64_t samples = kDistanceSamples;  ///< of each mesh
  /// All triangles are searched for the largest distance, not samples alone: OneSidedDistance::at_most bounds what may
  /// be missing, which is two thousandths or a billionth of the diagonal unless surfaces run side by side over many
  /// triangles, much closer than edges are long. Normals are compared with the best aligned of the triangles that are
  /// equally near, up to the rounding of files in single precision, a ten-millionth of the diagonal.
  bool exact = false;
};

/// Result: each mesh has one sample in each of its strata of equal area, along its triangles, and every n-th vertex, n
/// the smallest that leaves at most kDistanceVertices; the distances are exact up to rounding, sums run in one fixed
/// shape, and every backend finds the same figures. Unless `exact`, normals of a sample are compared with the nearest
/// triangle; where they turn, with those that lie within a ten-thousandth of the diagonal beyond it, too: beside a
/// crease either side of it may be the nearest. Cost: about four searches in grids of triangles a sample; 50 bytes a
/// triangle, at most 160; if exact, also a search for each vertex and triangle, at most some million more, and 500
/// bytes a triangle. Throws: usage when a mesh has no triangle or names a vertex that it does not have, or for no
/// samples.
MeshDistance measure_distance(const TriangleMesh& mesh, const TriangleMesh& reference, Context& context,
                              const DistanceOptions& options = {});

/// From each of the points, and nothing the other way: how far the mesh is from the surface that they are of is not
/// known any better than they are apart. Result: exact up to rounding, sums in the order of the points. Throws: usage
/// when there is no point, and as the other does.
MeshDistance measure_distance(const TriangleMesh& mesh, const std::vector<WorldPoint>& reference, Context& context);

/// Of each point to the nearest one of the mesh, exact up to rounding, world units. Throws: usage as measure_distance.
std::vector<double> distances(const std::vector<WorldPoint>& points, const TriangleMesh& mesh, Context& context);

/// The triangles of the input as the stages see it: snapped, and repaired where it was.
TriangleMesh to_world(const LatticeSurface& surface);

}  // namespace isoshell
