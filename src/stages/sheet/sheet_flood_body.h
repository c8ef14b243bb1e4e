// The part of build_sheet that finds the outside: every voxel that a path of face neighbours joins to the border of the
// lattice without entering a blocked voxel. Nodes are empty blocks of 128^3 voxels, empty leaves and leaves with
// blocked voxels, so nothing is ever as large as the lattice. Bits are only ever set: the fixed point does not depend
// on order.
#pragma once

#include "isoshell/advanced/buffer.h"
#include "voxel/atomic.h"
#include "voxel/leaf.h"
#include "voxel/leaf_bits.h"

namespace isoshell {

/// Bit per leaf of a block.
struct BlockMask {
  uint64_t word[64];
};

/// The outside of a set of blocked voxels, as kernels see it.
struct OutsideView {
  VoxelSetView blocked;
  View<LeafMask> leaf;    ///< per blocked leaf: its outside voxels
  View<BlockMask> empty;  ///< per block with blocked leaves: which of its empty leaves are outside
  View<uint32_t> block;   ///< per entry of the block table without blocked leaves: 1 when outside

  /// Outside voxels of the leaf at these leaf coordinates; beyond the lattice all are.
  ISOSHELL_HD LeafMask at(Voxel l) const {
    const int64_t t = table_index(l);
    if (t < 0) return uniform_leaf(true);
    const uint32_t b = blocked.block_table[t];
    if (b == kNone) return uniform_leaf(block[t] != 0);
    const uint32_t number = find_leaf(blocked, l);
    if (number != kNone) return leaf[number];
    const int bit = (l.x & 15) << 8 | (l.y & 15) << 4 | (l.z & 15);
    return uniform_leaf(empty[b].word[bit >> 6] >> (bit & 63) & 1);
  }
  /// Entry of the block table for a leaf, or -1 beyond the lattice.
  ISOSHELL_HD int64_t table_index(Voxel l) const {
    const Voxel b = {l.x >> 4, l.y >> 4, l.z >> 4};
    if (b.x < 0 || b.y < 0 || b.z < 0 || b.x >= blocked.block_dims[0] || b.y >= blocked.block_dims[1] ||
        b.z >= blocked.block_dims[2])
      return -1;
    return (int64_t(b.x) * blocked.block_dims[1] + b.y) * blocked.block_dims[2] + b.z;
  }
};

/// Owner of the arrays of an OutsideView; `blocked` belongs to someone else.
struct Outside {
  VoxelSetView blocked;
  Buffer<LeafMask> leaf;
  Buffer<BlockMask> empty;
  Buffer<uint32_t> block;
  OutsideView view() { return {blocked, leaf.view(), empty.view(), block.view()}; }
};

namespace sheet_steps {

/// Nodes to look at in the next round, each once: `stamp` is the last round a node was listed for, `left` counts down
/// from the capacity, so the list is the tail of `node`.
struct FloodList {
  View<uint32_t> stamp, node;
  View<uint32_t> left;
  ISOSHELL_HD void add(uint32_t n, uint32_t round) const {
    if (atomic_load(stamp[n]) < round && atomic_max(stamp[n], round)) node[atomic_take_one_below(left[0])] = n;
  }
};

/// What a flood step reads and where it writes. Bits set in a round are complete when the next one starts.
struct FloodState {
  OutsideView out;
  View<BlockMask> passed_on;  ///< empty leaves whose neighbours have heard of them
  FloodList leaves, blocks;
  uint32_t next_round;

  /// The outside has reached these voxels of a leaf, as far as they are free.
  ISOSHELL_HD void enter(Voxel l, const LeafMask& voxels) const {
    const int64_t t = out.table_index(l);
    if (t < 0) return;
    const uint32_t b = out.blocked.block_table[t];
    if (b == kNone) return enter_empty_block(t);
    const int bit = (l.x & 15) << 8 | (l.y & 15) << 4 | (l.z & 15);
    const LeafBlock& block = out.blocked.blocks[b];
    const uint64_t word = block.word[bit >> 6], one = uint64_t(1) << (bit & 63);
    if (word & one) {
      enter_blocked_leaf(block.first_leaf + block.before[bit >> 6] + uint32_t(popcount64(word & (one - 1))), voxels);
    } else if (uint64_t& seen = out.empty[b].word[bit >> 6]; !(atomic_load(seen) & one)) {
      atomic_or(seen, one);
      blocks.add(uint32_t(t), next_round);
    }
  }
  ISOSHELL_HD void enter_empty_block(int64_t t) const {
    if (atomic_load(out.block[t])) return;
    atomic_or(out.block[t], 1u);
    blocks.add(uint32_t(t), next_round);
  }
  ISOSHELL_HD void enter_blocked_leaf(uint32_t number, const LeafMask& voxels) const {
    LeafMask& seen = out.leaf[number];
    LeafMask fresh;  // all is read before anything is written: the reads do not wait for each other
    for (int x = 0; x < 8; ++x)
      fresh.word[x] = voxels.word[x] & ~out.blocked.mask[number].word[x] & ~atomic_load(seen.word[x]);
    bool grew = false;
    for (int x = 0; x < 8; ++x) {
      if (fresh.word[x]) atomic_or(seen.word[x], fresh.word[x]);
      grew |= fresh.word[x] != 0;
    }
    if (grew) leaves.add(number, next_round);
  }
  /// Enters the 256 leaves on one side of a block, coming through that side's neighbour.
  ISOSHELL_HD void enter_block_side(Voxel first_leaf, int face) const {
    const int64_t t = out.table_index(first_leaf);
    if (t < 0) return;
    if (out.blocked.block_table[t] == kNone) return enter_empty_block(t);
    const LeafMask voxels = crossing(uniform_leaf(true), face);
    const int32_t fixed = face & 1 ? 0 : 15;
    for (int32_t i = 0; i < 16; ++i)
      for (int32_t j = 0; j < 16; ++j)
        enter({first_leaf.x + (face < 2 ? fixed : i),
               first_leaf.y + (face >> 1 == 1 ? fixed
                               : face < 2     ? i
                                              : j),
               first_leaf.z + (face >> 1 == 2 ? fixed : j)},
              voxels);
  }
  /// Smallest leaf of an entry of the block table.
  ISOSHELL_HD Voxel first_leaf_of_entry(int64_t t) const {
    const int64_t xy = t / out.blocked.block_dims[2];
    return {int32_t(xy / out.blocked.block_dims[1]) * 16, int32_t(xy % out.blocked.block_dims[1]) * 16,
            int32_t(t % out.blocked.block_dims[2]) * 16};
  }
};

/// The border of the lattice is outside.
struct EnterFromBorder {
  FloodState state;
  ISOSHELL_HD void operator()(int64_t t) const {
    const Voxel first = state.first_leaf_of_entry(t);
    for (int face = 0; face < 6; ++face)
      if (state.out.table_index(step_through(first, face, 16)) < 0) state.enter_block_side(first, face ^ 1);
  }
};

struct EnterHollow {
  FloodState state;
  View<const Voxel> hollows;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Voxel v = hollows[i];
    LeafMask voxel = {};
    voxel.word[v.x & 7] = uint64_t(1) << (offset_in_leaf(v) & 63);
    state.enter(leaf_of_voxel(v), voxel);
  }
};

struct FloodBlock {
  FloodState state;
  View<const uint32_t> list;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t t = list[i], b = state.out.blocked.block_table[t];
    const Voxel first = state.first_leaf_of_entry(t);
    if (b == kNone) {
      for (int face = 0; face < 6; ++face) state.enter_block_side(step_through(first, face, 16), face);
      return;
    }
    uint64_t free[64], reached[64], fresh[64];
    for (int w = 0; w < 64; ++w) {
      free[w] = ~state.out.blocked.blocks[b].word[w];
      reached[w] = atomic_load(state.out.empty[b].word[w]);
    }
    flood_block(free, reached);
    for (int w = 0; w < 64; ++w) {
      fresh[w] = reached[w] & ~state.passed_on[b].word[w];
      if (!fresh[w]) continue;
      state.passed_on[b].word[w] = reached[w];
      atomic_or(state.out.empty[b].word[w], fresh[w]);
    }
    for (int w = 0; w < 64; ++w)
      for (uint64_t bits = fresh[w]; bits; bits &= bits - 1) {
        const int bit = w * 64 + lowest_bit(bits);
        const Voxel l = {first.x + (bit >> 8), first.y + ((bit >> 4) & 15), first.z + (bit & 15)};
        for (int face = 0; face < 6; ++face) state.enter(step_through(l, face), crossing(uniform_leaf(true), face));
      }
  }
};

struct FloodLeaf {
  FloodState state;
  View<const uint32_t> list;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t number = list[i];
    LeafMask free, reached;
    for (int x = 0; x < 8; ++x) {
      free.word[x] = ~state.out.blocked.mask[number].word[x];
      reached.word[x] = atomic_load(state.out.leaf[number].word[x]);
    }
    const LeafMask before = reached;
    flood_leaf(free, reached);
    for (int x = 0; x < 8; ++x)
      if (reached.word[x] != before.word[x]) atomic_or(state.out.leaf[number].word[x], reached.word[x]);
    const Voxel l = leaf_of_key(state.out.blocked.leaf_key[number]);
    for (int face = 0; face < 6; ++face) {
      const LeafMask voxels = crossing(reached, face);
      uint64_t any = 0;
      for (uint64_t w : voxels.word) any |= w;
      if (any) state.enter(step_through(l, face), voxels);
    }
  }
};

/// Two worklists that trade places every round.
template <class Exec>
struct FloodQueue {
  Buffer<uint32_t> stamp, node[2], left;
  int current = 0;

  FloodQueue(Exec& exec, int64_t capacity)
      : stamp(exec.template make<uint32_t>(capacity)),
        node{exec.template make<uint32_t>(capacity), exec.template make<uint32_t>(capacity)},
        left(exec.template make<uint32_t>(2)) {
    exec.fill(stamp.view(), 0u);
    exec.fill(left.view(), uint32_t(capacity));
  }
  /// Where the next round's nodes go.
  FloodList next() { return {stamp.view(), node[1 - current].view(), {left.data() + (1 - current), 1}}; }
  /// Makes the next round current and returns its nodes.
  View<const uint32_t> advance(Exec& exec) {
    exec.fill(left.view().part(current, 1), uint32_t(stamp.size()));
    current = 1 - current;
    const int64_t begin = exec.value(View<const uint32_t>(left.view()), current);
    return {node[current].data() + begin, stamp.size() - begin};
  }
};

}  // namespace sheet_steps

/// Result: outside are the voxels that are not in `blocked` and that a path of face neighbours which are not in
/// `blocked` either joins to the border of the lattice or to one of `hollows`. Cost: each leaf is visited once per wave
/// of new outside voxels.
struct PlainFindOutside {
  template <class Exec>
  static Outside run(Exec& exec, const VoxelSetView& blocked, View<const Voxel> hollows) {
    using namespace sheet_steps;
    Outside outside;
    outside.blocked = blocked;
    outside.leaf = exec.template make<LeafMask>(blocked.leaf_key.size);
    outside.empty = exec.template make<BlockMask>(blocked.blocks.size);
    outside.block = exec.template make<uint32_t>(blocked.block_table.size);
    Buffer<BlockMask> passed_on = exec.template make<BlockMask>(blocked.blocks.size);
    exec.fill(outside.leaf.view(), LeafMask{});
    exec.fill(outside.empty.view(), BlockMask{});
    exec.fill(passed_on.view(), BlockMask{});
    exec.fill(outside.block.view(), 0u);

    FloodQueue<Exec> leaves(exec, blocked.leaf_key.size), blocks(exec, blocked.block_table.size);
    FloodState state = {outside.view(), passed_on.view(), leaves.next(), blocks.next(), 1};
    exec.for_each("enter from the border", blocked.block_table.size, EnterFromBorder{state});
    exec.for_each("enter hollows", hollows.size, EnterHollow{state, hollows});
    for (;;) {
      const View<const uint32_t> leaf_list = leaves.advance(exec), block_list = blocks.advance(exec);
      if (leaf_list.empty() && block_list.empty()) return outside;
      state.leaves = leaves.next();
      state.blocks = blocks.next();
      ++state.next_round;
      exec.for_each("flood blocks", block_list.size, FloodBlock{state, block_list});
      exec.for_each("flood leaves", leaf_list.size, FloodLeaf{state, leaf_list});
    }
  }
};

}  // namespace isoshell
