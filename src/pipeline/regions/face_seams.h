// Where faces of one wall have different labels of an attribute, as the materials of pieces of a fracture.
#pragma once

#include "features/mesh/feature_mesh.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// The edges between two faces that part the same regions and differ in an attribute of faces with labels; each smaller
/// end first, ascending. `walls` were made of the soup, and say so by their source faces. Cost: nothing without such an
/// attribute, else a sort of the edges.
EdgeList face_seams(const FeatureMesh& walls, const TriangleSoup& soup);

}  // namespace isoshell
