// What of a result has no surface under it, and where walls are nearer than the grid can tell.
#pragma once

#include <cstdint>
#include <vector>

#include "isoshell/advanced/sheet.h"
#include "isoshell/advanced/site_set.h"

namespace isoshell {

/// What closes gaps of the input, by faces or by voxels.
struct GapReport {
  double area_world = 0;           ///< of the sheet there
  int64_t vertices = 0;            ///< of the result
  int64_t bridges = 0;             ///< gaps that voxels bridge, two of them wide or more
  double widest_bridge_world = 0;  ///< to a voxel and a tenth of itself
};

/// Per vertex of the sheet 1 where it bridges a gap between voxels: none of those around its corner holds surface.
std::vector<uint8_t> find_bridges(const SiteSet& sites, const Sheet& sheet);

/// Number of connected bridges and the width of the widest: twice the farthest that one of its corners is from its rim,
/// and a voxel more for those that hold the rims. Cost: O(bridging vertices), with a queue.
void measure_bridges(const Sheet& sheet, const std::vector<uint8_t>& bridges, GapReport& report);

/// Per vertex of the sheet 1 where it bridges or lies on a face that closes a hole; empty when none does.
std::vector<uint8_t> find_gaps(const LatticeSurface& surface, const Sheet& sheet, const std::vector<uint8_t>& bridges);

/// The voxels around the corners of the vertices that bridge, each once, sorted.
std::vector<Voxel> bridging_voxels(const Sheet& sheet, const std::vector<uint8_t>& bridges);

/// Area of the sheet's triangles whose three vertices lie in gaps.
double gap_area_world(const Sheet& sheet, const std::vector<uint8_t>& gaps);

/// Per site 1 where it also sees a triangle that faces away from its own, by more than 120 degrees, and shares no
/// corner with it: two walls in one voxel, which the shell joins. Empty when the samples list no triangles. Cost: a
/// look at each triangle of each site.
std::vector<uint8_t> find_risks(const LatticeSurface& surface, const SiteSamples& samples);

}  // namespace isoshell
