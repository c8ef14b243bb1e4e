// What the vertices of a frame have done since the frame before.
#pragma once

#include "isoshell/previous_frame.h"

namespace isoshell {

/// Gives the mesh the vertex attributes `born`, 1 where a vertex is not the one of its number in the frame before, and
/// vx, vy and vz, its motion since then in world units, 0 where it was born; in place of the input's of these names.
void add_motion_attributes(const PreviousFrame& previous, TriangleMesh& mesh);

}  // namespace isoshell
