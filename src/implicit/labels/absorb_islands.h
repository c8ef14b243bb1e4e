// Specks in volumes of labels, which no mesh of the whole can show.
#pragma once

#include <array>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/regions.h"

namespace isoshell {

/// What was done to a volume.
struct AbsorbedIslands {
  int64_t islands = 0, voxels = 0;
  std::vector<std::array<int32_t, 2>>
      lost_pairs;  ///< of regions that shared faces before, ascending; the smaller first
};

/// Gives every island of fewer than volume.smallest_island_vox voxels, connected through faces, the label that most
/// voxels beside it have that are of no such island; of equal ones the smallest. The largest island of each region
/// stays however small it is, and so does background that reaches the sides of the array. Throws: interrupted. Cost: a
/// look at all voxels, and few at the runs of equal ones along x.
AbsorbedIslands absorb_islands(LabelVolume& volume, const Context& context);

}  // namespace isoshell
