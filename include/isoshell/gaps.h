// What of a result has no surface under it, and where walls are nearer than the grid can tell.
#pragma once

#include <cstdint>
#include <vector>

#include "isoshell/sheet.h"
#include "isoshell/site_set.h"

namespace isoshell {

/// What closes gaps of the input, by faces or by voxels.
struct GapReport {
  double area_world = 0;  ///< of the sheet there
  int64_t vertices = 0;   ///< of the result
};

/// Per vertex of the sheet 1 where it lies on a face that closes a hole, or bridges a gap between voxels; empty when
/// none does.
std::vector<uint8_t> find_gaps(const LatticeSurface& surface, const Sheet& sheet);

/// Area of the sheet's triangles whose three vertices lie in gaps.
double gap_area_world(const Sheet& sheet, const std::vector<uint8_t>& gaps);

/// Per site 1 where it also sees a triangle that faces away from its own, by more than 120 degrees, and shares no
/// corner with it: two walls in one voxel, which the shell joins. Empty when the samples list no triangles. Cost: a
/// look at each triangle of each site.
std::vector<uint8_t> find_risks(const LatticeSurface& surface, const SiteSamples& samples);

}  // namespace isoshell
