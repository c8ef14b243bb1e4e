// Parts of space in which walls are changed at once.
#pragma once

#include <cstddef>
#include <vector>

#include "features/walls/wall_mesh.h"

namespace isoshell {

/// Cubes, each with the vertices in it that are not settled. What is changed around vertices of one, and stays in it,
/// meets nothing that is changed in another one. The same for every number of threads.
class WallBlocks {
 public:
  /// From vertices in the middle of each cube of blocks that are not shifted to those of the next. Cost: a sort of the
  /// vertices.
  WallBlocks(const WallMesh& mesh, double side_q8, bool is_shifted);

  size_t size() const { return first_.size() - 1; }
  View<const uint32_t> vertices_of(size_t block) const {
    return {vertices_.data() + first_[block], int64_t(first_[block + 1] - first_[block])};
  }
  bool holds(size_t block, const WorldPoint& p) const { return key(p) == keys_[block]; }
  /// Whether all triangles around a vertex are in a block.
  bool holds_around(size_t block, uint32_t v) const;

 private:
  uint64_t key(const WorldPoint& p) const;

  const WallMesh* mesh_;
  double side_q8_, shift_q8_;
  std::vector<uint64_t> keys_;      ///< per block, of its place
  std::vector<size_t> first_;       ///< per block its first vertex in vertices_, and their end
  std::vector<uint32_t> vertices_;  ///< block by block, ascending; settled ones are missing
  std::vector<uint32_t> block_of_;  ///< per vertex
};

/// A side of blocks whose tasks are worth it: some edges of a result with so many vertices, in lattice steps.
double side_of_blocks_q8(const WallMesh& mesh, int64_t vertices);

}  // namespace isoshell
