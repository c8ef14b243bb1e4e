// How far the boundary of the voxels that meet a surface lies outside of it.
#pragma once

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// `p` moved along `n` by half of what a voxel of `edge_q8` (below zero: inwards) measures along it: by the mean
/// distance between a surface and the boundary of the voxels that it meets.
ISOSHELL_HD inline PointQ8 moved_by_proxy_depth(PointQ8 p, Normal8 n, int32_t edge_q8) {
  const auto size = [](int8_t c) { return c < 0 ? -c : int32_t(c); };
  const int64_t depth = int64_t(size(n.x) + size(n.y) + size(n.z)) * edge_q8;  // in 1/254 q8
  constexpr int64_t kUnit = 2 * 127 * 127;
  return {p.x + int32_t(n.x * depth / kUnit), p.y + int32_t(n.y * depth / kUnit), p.z + int32_t(n.z * depth / kUnit)};
}

}  // namespace isoshell
