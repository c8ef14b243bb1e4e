// NanoVDB's node layout as plain numbers, for code that must not see NanoVDB: where the parts of an index grid lie, and
// where the fields of its nodes.
#pragma once

#include <cstdint>

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

constexpr int64_t kNanoLeafBytes = 96;
constexpr int64_t kNanoLeafMask = 16;   ///< after the box's smallest corner, 12 bytes, its size, 3, and the flags, 1
constexpr int64_t kNanoLeafWords = 80;  ///< two words of 64 bits behind the mask: first value, and another

/// Bytes from the start of a node to a field; tables hold a child's distance in bytes from its parent.
struct NanoNode {
  int64_t bytes, box, child_mask, table;
};

struct NanoNodes {
  NanoNode upper, lower;
  uint8_t leaf_flags;
  int first_value_word;  ///< which of the leaf's two words holds the value of its first active voxel
  bool prefix_sums;      ///< the other: active voxels before words 1 to 7 of the mask, nine bits each; or zero
};
NanoNodes nano_nodes();

/// Where the parts of the grid lie, in bytes from its start.
struct NanoLayout {
  int64_t leaves = 0, lowers = 0, uppers = 0, voxels = 0;  ///< counts
  int64_t root = 0, first_upper = 0, first_lower = 0, first_leaf = 0, end = 0;
  int64_t root_box = 0, world_box = 0;  ///< six int32_t, six double
};
NanoLayout nano_layout(int64_t leaves, int64_t lowers, int64_t uppers, int64_t voxels);

/// World coordinates along an axis of index coordinate 0.
double nano_shift(const LatticeFrame& frame, int axis);

/// The bytes before the first upper node, complete but for the boxes. `upper_key`: leaf key >> 27, ascending.
/// Throws: usage when the name is too long.
Buffer<std::byte> nano_head(const NanoLayout& at, const uint64_t* upper_key, const LatticeFrame& frame,
                            const char* name);

}  // namespace isoshell
