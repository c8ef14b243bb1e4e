// The lattice points of a field's blocks as numbered nodes, and the space around the blocks as few more.
#pragma once

#include <vector>

#include "implicit/volumes/scalar_field.h"

namespace isoshell {

constexpr uint32_t kBlockPoints = 512;

/// Nodes: point `offset` of block b is node 512 b + offset, z fastest; behind them, one for the space outside of all
/// blocks and one for every gap between two blocks that follow each other along z. Gaps that touch are not one node.
class BlockLattice {
 public:
  /// Blocks in any order; at most 2^22. Cost: a sort.
  explicit BlockLattice(std::vector<Voxel> blocks);

  const std::vector<Voxel>& blocks() const { return blocks_; }
  uint32_t block_count() const { return uint32_t(blocks_.size()); }
  uint32_t node_count() const { return node_count_; }
  uint32_t outside() const { return kBlockPoints * block_count(); }
  bool is_in_block(uint32_t node) const { return node < outside(); }

  /// The first node of the block at an origin, or the node of the space there.
  uint32_t node_at(Voxel origin) const;

  /// Calls visit(a, b) for pairs of gaps, or of a gap and the outside, that touch. Cost: linear in the blocks.
  template <class Visit>
  void each_touching_gap(Visit visit) const {
    constexpr int32_t kSteps[4][2] = {{kFieldBlock, 0}, {-kFieldBlock, 0}, {0, kFieldBlock}, {0, -kFieldBlock}};
    for (uint32_t b = 0; b + 1 < block_count(); ++b) {
      if (gap_after_[b] == outside()) continue;
      for (const auto& step : kSteps) {
        Voxel beside{blocks_[b].x + step[0], blocks_[b].y + step[1], blocks_[b].z + kFieldBlock};
        while (beside.z < blocks_[b + 1].z) {
          const size_t next = first_from(beside);
          const bool held = next < blocks_.size() && blocks_[next] == beside;
          if (!held) visit(gap_after_[b], gap_before(next, beside));
          const bool in_column = next < blocks_.size() && same_column(blocks_[next], beside);
          if (!in_column) break;
          beside.z = blocks_[next].z + (held ? kFieldBlock : 0);
        }
      }
    }
  }

 private:
  static bool same_column(Voxel a, Voxel b) { return a.x == b.x && a.y == b.y; }
  size_t first_from(Voxel origin) const;
  /// Of a place that no block holds; `next` is the first block behind it.
  uint32_t gap_before(size_t next, Voxel origin) const {
    return next > 0 && same_column(blocks_[next - 1], origin) ? gap_after_[next - 1] : outside();
  }

  std::vector<Voxel> blocks_;        ///< sorted by x, then y, then z
  std::vector<uint32_t> gap_after_;  ///< per block the node of the space behind it along z
  uint32_t node_count_ = 0;
};

}  // namespace isoshell
