// The same triangles on opposite sides of a periodic volume.
#pragma once

#include "features/angles/cut_lookup.h"
#include "features/mesh/editable_mesh.h"

namespace isoshell {

/// Whether some sides of the surface are to have the triangles of those opposite.
bool has_periodic_sides(const CutSurface& cut);

/// Curves on the second one of two opposite sides get the vertices of those on the first one: edges are split and
/// collapsed and vertices moved there, and where a vertex cannot go, the first side gets one, too. Then triangles of
/// the first side are copied, translated by the period. Vertices of both stay as they are from then on. No triangles
/// come to intersect. Cost: O(mesh), and the sides' curves times their vertices. Throws: usage where curves cannot get
/// the same vertices, with a place.
EditableMesh with_same_sides(const CutLookup& lookup, EditableMesh mesh);

}  // namespace isoshell
