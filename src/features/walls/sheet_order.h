// The order of sheets around the edges that they share.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "features/mesh/editable_mesh.h"

namespace isoshell {

/// The region behind each patch and the one before it.
using PatchLabels = std::vector<std::array<int32_t, 2>>;

/// Whether around each edge of three triangles or more that a change makes each one faces the region that the next one
/// has behind it: otherwise a piece of a region as flat as a few triangles was turned inside out, though nothing
/// intersects. Where two lie on each other their order is any. Cost: the triangles around the ends of edges on curves.
bool are_sheets_in_order(const EditableMesh& mesh, const MeshChange& change, const PatchLabels& labels);

/// The same, or they are not in order before the change, as where triangles intersect that are collapsed for it. For
/// changes that move no vertex.
bool keeps_sheets_in_order(const EditableMesh& mesh, const MeshChange& change, const PatchLabels& labels);

}  // namespace isoshell
