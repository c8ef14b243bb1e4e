// Which offsets of the walls between regions give these the volumes that they lack.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// Six times the volume of the tetrahedron with the origin. What overflows comes right in sums that do not.
uint64_t spanned_volume(const PointQ8& a, const PointQ8& b, const PointQ8& c);

/// All walls between two regions, by their numbers: that behind the walls, and that in front.
struct WallsBetween {
  std::array<uint32_t, 2> region{0, 0};
  double area = 0;
};

/// Every pair of regions has one offset for all of its walls, along their normals. Of the offsets that give every
/// region the volume that it lacks, to first order, those are taken whose squares, each times the area of its walls,
/// have the least sum: the offset of a pair then is a pressure of its one region less that of its other one, as of
/// bubbles in foam, and the pressures solve a Laplace equation on the graph of regions. Result: the pressures, by the
/// numbers of regions. Cost: at most 30 steps over the walls; what is left then is for the next offsets.
std::vector<double> pressures_of_regions(const std::vector<WallsBetween>& walls, std::vector<double> lacking_volume);

}  // namespace isoshell
