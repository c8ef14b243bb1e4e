// How far a mesh is from another one, both ways.
#pragma once

#include "isoshell/backend.h"
#include "isoshell/lattice_surface.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Of points of one mesh to the nearest points of the other one, world units.
struct OneSidedDistance {
  double mean = 0, rms = 0;  ///< of the area samples
  double max = 0;            ///< of the area samples and the vertices: a lower bound, the true one may lie between them
};
struct MeshDistance {
  OneSidedDistance to_reference, from_reference;
  double diagonal = 0;  ///< of the reference's bounding box

  /// The Hausdorff distance, as far as the samples show it.
  double largest() const { return to_reference.max > from_reference.max ? to_reference.max : from_reference.max; }
};

constexpr int64_t kDistanceSamples = 50000;   ///< of each mesh
constexpr int64_t kDistanceVertices = 50000;  ///< most vertices of each mesh that are looked at

/// Result: each mesh has one sample in each of kDistanceSamples strata of equal area, along its triangles, and every
/// n-th vertex, n the smallest that leaves at most kDistanceVertices; the distances are exact up to rounding, sums run
/// in one fixed shape. Cost: about 200,000 searches in grids of triangles; 50 bytes a triangle, at most 160.
/// Throws: usage when a mesh has no triangle or names a vertex that it does not have.
MeshDistance measure_distance(const TriangleMesh& mesh, const TriangleMesh& reference, Context& context);

/// The triangles of the input as the stages see it: snapped, and repaired where it was.
TriangleMesh to_world(const LatticeSurface& surface);

}  // namespace isoshell
