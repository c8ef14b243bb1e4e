// Flaps: open parts of a surface whose other parts bound a solid. The outside reaches both of their sides, which would
// be laid onto the same faces, and cross.
#pragma once

#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

/// Gives a prepared surface that has flaps the sheet of its solid together with all voxels within `grown_vox` of a
/// flap: laid onto the surface but for the flaps, which it follows at that distance. Off-surface points stay but for
/// those at flaps. Returns whether there are any flaps.
bool grow_flaps(PreparedSurface& prepared, int32_t grown_vox, int64_t smallest_component_q16, Context& context);

}  // namespace isoshell
