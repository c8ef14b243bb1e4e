// Which regions come near to one another without sharing a wall.
#pragma once

#include <array>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell {
namespace repair {

/// Two regions, the smaller label first, whose walls have no vertex in common, nor both one with the same third region.
struct NearRegions {
  std::array<int32_t, 2> labels;
  double distance_world;
  WorldPoint at;  ///< where one is nearest to the other
};

/// Those nearer than `within_world`, the nearest first. Result: the same for every number of threads. Cost: a tree of
/// the boxes of faces, and the distance of each two that are as near.
std::vector<NearRegions> find_near_regions(const TriangleSoup& walls, double within_world, const Context& context);

}  // namespace repair
}  // namespace isoshell
