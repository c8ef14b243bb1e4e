// Which parts of a surface, components and handles, so many vertices can show, and what is said of those that they
// cannot.
#pragma once

#include "pipeline/grid/prepared_surface.h"
#include "pipeline/grid/run_log.h"

namespace isoshell {

/// Whether so many vertices can show each component and each handle of the input; clouds of smoke have hundreds.
bool shows_all_parts(int64_t vertices, const InputTopology& input);

/// False for smoke and foam: walls and gaps are as narrow as handles are many, and would cross.
bool shows_most_handles(int64_t vertices, const InputTopology& input);

/// Whether a mesh of so many vertices has room for each component and handle, in triangles of whatever shape.
bool has_room_for_parts(int64_t vertices, const InputTopology& input);

/// Whether a surface has so little area that cells of the result would be far narrower than voxels: it is thinner than
/// a voxel all over.
bool is_needle(const PreparedSurface& prepared);

/// Sheet components smaller than a few cells are noise of dirty input; a clean input has none to lose, unless there are
/// more than the vertices can show.
int64_t smallest_component_q16(const PreparedSurface& prepared);

/// Warns where the sheet, as prepared.report says, is not of the input's topology.
void warn_of_topology(const PreparedSurface& prepared, const InputTopology& input, Run& run);

}  // namespace isoshell
