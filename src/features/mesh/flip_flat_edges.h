// Better triangles where the input is flat.
#pragma once

#include "features/mesh/refine_mesh.h"

namespace isoshell {

/// Whether triangles a, b, c and b, a, d are in a plane, to half a step of the lattice, and face the same way.
bool are_in_plane(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c, const WorldPoint& d);

/// Flips edges between two triangles in a plane until the mesh is Delaunay there: parts have long thin triangles in
/// their flat faces, whose vertices are no neighbours of those that are near to them, and cells of seeds would come in
/// pieces. The surface stays as it is to half a step of the lattice, edges of paths stay, no edge becomes longer than
/// those around it, and none comes to have more than two triangles. Result: independent of the order of triangles.
/// Cost: a sort of the half-edges. `twins` become those of the result between paths.
FineMesh flip_flat_edges(FineMesh mesh, MeshTwins* twins = nullptr);

}  // namespace isoshell
