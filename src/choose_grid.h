// Which grid a run starts with.
#pragma once

#include "isoshell/remesh.h"

namespace isoshell {

/// Target count of a surface of this area.
int64_t vertex_target(const RemeshOptions& options, double area_world);

/// Voxels along the longest side of the box: the user's, or so many that a cell is about six voxels wide.
int32_t first_resolution(const RemeshOptions& options, double area_world, WorldPoint box_min, WorldPoint box_max);

}  // namespace isoshell
