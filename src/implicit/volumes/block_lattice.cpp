#include "implicit/volumes/block_lattice.h"

#include <tbb/parallel_sort.h>

#include <algorithm>

#include "implicit/volumes/tile_borders.h"

namespace isoshell {

BlockLattice::BlockLattice(std::vector<Voxel> blocks) : blocks_(std::move(blocks)) {
  tbb::parallel_sort(blocks_.begin(), blocks_.end(), comes_before);
  node_count_ = outside() + 1;
  gap_after_.assign(blocks_.size(), outside());
  for (size_t b = 0; b + 1 < blocks_.size(); ++b)
    if (same_column(blocks_[b], blocks_[b + 1]) && blocks_[b + 1].z != blocks_[b].z + kFieldBlock)
      gap_after_[b] = node_count_++;
}

size_t BlockLattice::first_from(Voxel origin) const {
  return size_t(std::lower_bound(blocks_.begin(), blocks_.end(), origin, comes_before) - blocks_.begin());
}

uint32_t BlockLattice::node_at(Voxel origin) const {
  const size_t next = first_from(origin);
  if (next < blocks_.size() && blocks_[next] == origin) return uint32_t(next) * kBlockPoints;
  return gap_before(next, origin);
}

}  // namespace isoshell
