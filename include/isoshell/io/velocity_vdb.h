// Velocity fields from .vdb files.
#pragma once

#include <memory>
#include <string>

#include "isoshell/previous_frame.h"

namespace isoshell {

/// Reads a grid of three floats a voxel by its name. Between active voxels velocities are interpolated; others do not
/// count. Throws: unreadable_input (names file, grid and remedy) also where a value is not finite; out_of_memory for a
/// file larger than `max_bytes` (0: no limit).
std::shared_ptr<const VelocityField> read_velocity(const std::string& path, const std::string& grid,
                                                   int64_t max_bytes = 0);

}  // namespace isoshell
