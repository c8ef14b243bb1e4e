// Velocity fields from .vdb files and from memory.
#pragma once

#include <array>
#include <memory>
#include <string>

#include "isoshell/io/memory_input.h"
#include "isoshell/previous_frame.h"

namespace isoshell {

/// Reads a grid of three floats a voxel by its name. Between active voxels velocities are interpolated; others do not
/// count. Throws: unreadable_input (names file, grid and remedy) also where a value is not finite; out_of_memory for a
/// file larger than `max_bytes` (0: no limit).
std::shared_ptr<const VelocityField> read_velocity(const std::string& path, const std::string& grid,
                                                   int64_t max_bytes = 0);

/// The same from values in memory, which are copied: a volume for each component, all on the lattice of the first. A
/// place where one is NaN is what an inactive voxel is in a file. `name` is what messages call the field. Throws: usage
/// for steps that span no volume; unreadable_input for a value that is infinite.
std::shared_ptr<const VelocityField> velocity_of(const std::array<DenseVolume, 3>& components, const std::string& name);

}  // namespace isoshell
