// Which faces of pieces lie on the surface that they were cut from.
#pragma once

#include "isoshell/surface_source.h"

namespace isoshell {

/// Adds the attribute "material" of faces: "exterior" are those between a region and the background that lie within
/// half a voxel of the reference, and face as it does, "inner" all others. Patches of few faces are as what is around
/// them. Result: the same for any number of threads. Cost: a search for the nearest triangle of the reference a face,
/// and a sort of edges. Throws: nothing_to_mesh for a reference without a triangle.
/// What counts is where each face crosses a line between centres of voxels, `crossings` of the volume of labels: faces
/// of one side then have vertices on it, or on its edges.
/// Result: 0, or where no face is exterior how far the nearest one to the background is from the reference, in voxels.
double mark_faces_on_reference(const TriangleSoup& reference, const std::string& name,
                               const std::vector<WallCrossing>& crossings, const LabelVolume& lattice,
                               TriangleSoup& walls);

}  // namespace isoshell
