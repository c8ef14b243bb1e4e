// Volumes of labels as files: grids of integers of .vdb files.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "isoshell/regions.h"

namespace isoshell {

struct LabelReadOptions {
  std::string grid = {};           ///< as in VolumeReadOptions; empty takes the only grid of labels
  int64_t memory_limit_bytes = 0;  ///< refuse grids that would need more, before they are read; 0 means no limit
  std::optional<int32_t> background = {};  ///< the label of what is no region; without a value the grid's background
};

/// Reads an Int32Grid or Int64Grid. The array is the box of all voxels that are active or differ from the grid's
/// background. The result's background is that of the options, which inactive voxels of the grid's have, too. The
/// transform may be any affine one. A name is metadata of type string of the grid: "label:7" with the value "femur"
/// calls the region 7 so. Throws: unreadable_input for a damaged file, labels beyond 32 bits, and transforms that are
/// frustums or have no inverse; nothing_to_mesh where no grid holds labels or all voxels are background; usage when the
/// grid must be named; out_of_memory over the limit.
LabelVolume read_labels(const std::string& path, const LabelReadOptions& options = {});

struct LabelWriteOptions {
  std::string grid = "labels";  ///< its name
  bool overwrite = false;
};

/// Writes an Int32Grid whose active voxels are those of the array, so that read_labels gives the same volume. Throws:
/// unwritable_output; usage for an array without voxels, a number of labels that is not theirs, or steps that no .vdb
/// file can hold.
void write_labels(const std::string& path, const LabelVolume& volume, const LabelWriteOptions& options = {});

}  // namespace isoshell
