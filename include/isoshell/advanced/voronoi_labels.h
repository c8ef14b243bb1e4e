// Voronoi labels: the seed of every active shell voxel (the volume people inspect).
#pragma once

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// Seed ids; kNone where no seed reaches.
struct VoronoiLabels {
  Buffer<uint32_t> voxel_seed;  ///< active-voxel order of the shell
};

}  // namespace isoshell
