// Sizing fields from .vdb files and from memory.
#pragma once

#include <memory>
#include <string>

#include "isoshell/io/memory_input.h"
#include "isoshell/sizing.h"

namespace isoshell {

/// Reads a FloatGrid of edge lengths in world units: "FIELD.vdb" with one float grid, or "FIELD.vdb:grid",
/// which is named as in VolumeReadOptions. Between the voxels of its active region lengths are interpolated; outside of
/// it the background counts, if it is more than 0.
/// Throws: unreadable_input (names file, grid, value and remedy) also where an active value is no length; out_of_memory
/// for a file larger than `max_bytes` (0: no limit).
std::shared_ptr<const SizingField> read_sizing(const std::string& source, int64_t max_bytes = 0);

/// The same from values in memory, which are copied; NaN is what an inactive voxel is in a file. `name` is what
/// messages call the field. Throws: usage for an array without values or a spacing that is not above 0; as read_sizing
/// does.
std::shared_ptr<const SizingField> sizing_of(const DenseVolume& lengths, const std::string& name);

}  // namespace isoshell
