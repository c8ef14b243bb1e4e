// Which regions come near to one another without sharing a wall.
#pragma once

#include <array>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell {
namespace repair {

/// Two regions, the smaller label first, whose walls nowhere have a vertex in common.
struct NearRegions {
  std::array<int32_t, 2> labels;
  double distance_world;  ///< the least there is between a vertex or a middle of a face of one and a face of the other
  WorldPoint at;          ///< of that vertex or middle
};

/// Those nearer than `within_world`, the nearest first. Result: the same for every number of threads. Cost: a grid of
/// the faces, and a search from each vertex and face.
std::vector<NearRegions> find_near_regions(const TriangleSoup& walls, double within_world, const Context& context);

}  // namespace repair
}  // namespace isoshell
