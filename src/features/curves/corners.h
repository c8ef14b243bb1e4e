// Where a curve turns so sharply that it has a corner.
#pragma once

#include <cstddef>

#include "features/curves/edge_chains.h"

namespace isoshell {

/// Places in chain.vertex, ascending, at least .7 h from one another along the chain, where it turns by more than 45
/// degrees between the .7 h before and behind, and not as evenly as a circle does. Ends are not looked at, nor
/// the teeth of a border that is a saw.
std::vector<size_t> corners_inside(const FeatureMesh& mesh, const EdgeChain& chain, double edge_length_world);

}  // namespace isoshell
