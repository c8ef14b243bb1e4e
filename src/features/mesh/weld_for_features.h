// From a soup to the mesh that features are looked for on.
#pragma once

#include "features/mesh/feature_mesh.h"
#include "isoshell/advanced/lattice_surface.h"

namespace isoshell {

/// Result: the positions that triangles use are the vertices, in the order of x, y, z (-0 is 0); triangles have three
/// of them, start at their smallest, and are sorted. Of triangles of the same corners the first in the soup stays,
/// whichever way it faces. So the mesh depends on the order of the soup in source_face only, and where triangles that
/// face each other have the same corners. Cost: a sort of the vertices, and sorts of the triangles of each.
FeatureMesh weld_for_features(const TriangleSoup& soup);

/// The same of to_world(surface), which is in host memory; but of triangles of the same corners that are less than 8
/// steps of the lattice high and half of which face the other way none stays: what they enclosed has been rounded away.
/// Cost: less, as its points are distinct whole numbers.
FeatureMesh weld_for_features(const LatticeSurface& surface);

}  // namespace isoshell
