// flood_shell (see stages.h), written once over an executor. Section 3.4 of the paper: seeds spread through the shell.
//
// A voxel gets its label in the round after its first neighbour did, so its labelled neighbours are exactly those of
// the round before. Each round therefore visits only leaves near voxels of the round before (the front), grows their
// masks by bit operations, and looks at labels only for voxels that are new: every voxel is labelled once.
#pragma once

#include "isoshell/advanced/stages.h"
#include "voxel/atomic.h"
#include "voxel/dilate.h"
#include "voxel/exact_int.h"

namespace isoshell {
namespace flood {

/// Where a seed starts.
struct Start {
  int64_t voxel;
  int64_t distance_sq_q16;
  uint32_t seed, zero = 0;
};
struct StartLess {
  ISOSHELL_HD bool operator()(const Start& a, const Start& b) const {
    if (a.voxel != b.voxel) return a.voxel < b.voxel;
    if (a.distance_sq_q16 != b.distance_sq_q16) return a.distance_sq_q16 < b.distance_sq_q16;
    return a.seed < b.seed;
  }
};

struct FindStart {
  VoxelSetView voxels;
  View<const PointQ8> position;
  View<Start> start;

  ISOSHELL_HD void operator()(int64_t i) const {
    const PointQ8 p = position[i];
    const Voxel v = voxel_of(p);
    const int64_t index = find_voxel(voxels, v);
    start[i] =
        index >= 0 ? Start{index, distance_sq_q16(voxel_centre(v), p), uint32_t(i)} : nearest_active(p, uint32_t(i));
  }

  /// Rings of leaves around the seed's, until no voxel beyond can be nearer. Rare: a seed on a bridge over a gap.
  ISOSHELL_HD Start nearest_active(PointQ8 p, uint32_t seed) const {
    const Voxel middle = leaf_of_voxel(voxel_of(p));
    Start best{-1, INT64_MAX, seed};
    int32_t most = 0;
    for (int axis = 0; axis < 3; ++axis) most = voxels.block_dims[axis] > most ? voxels.block_dims[axis] : most;
    for (int32_t ring = 0; ring <= 16 * most; ++ring) {
      // Centres in this ring are farther than ring - 1 whole leaves.
      const int64_t gap = int64_t(ring - 1) * 8 * kOneVoxelQ8;
      if (best.voxel >= 0 && ring > 0 && gap * gap > best.distance_sq_q16) break;
      for (int32_t x = -ring; x <= ring; ++x)
        for (int32_t y = -ring; y <= ring; ++y) {
          const bool whole = x == -ring || x == ring || y == -ring || y == ring;
          for (int32_t z = -ring; z <= ring; z += whole || ring == 0 ? 1 : 2 * ring)
            look_in({middle.x + x, middle.y + y, middle.z + z}, p, best);
        }
    }
    return best;
  }
  ISOSHELL_HD void look_in(Voxel at, PointQ8 p, Start& best) const {
    const uint32_t leaf = find_leaf(voxels, at);
    if (leaf == kNone) return;
    for_each_active(voxels, leaf, [&](int offset, int64_t index) {
      const int64_t d = distance_sq_q16(voxel_centre(voxel_at(at, offset)), p);
      if (d < best.distance_sq_q16 || (d == best.distance_sq_q16 && index < best.voxel)) best = {index, d, best.seed};
    });
  }
};

struct Neighbours {
  uint32_t leaf[27];
};
struct FindNeighbours {
  VoxelSetView voxels;
  View<Neighbours> out;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    const Voxel at = leaf_of_key(voxels.leaf_key[leaf]);
    for (int n = 0; n < 27; ++n)
      out[leaf].leaf[n] = find_leaf(voxels, {at.x + n / 9 - 1, at.y + n / 3 % 3 - 1, at.z + n % 3 - 1});
  }
};

/// Voxels that got their label in one round. A leaf's mask counts only while its round is the one asked for, so nothing
/// needs clearing between rounds.
struct Front {
  View<LeafMask> mask;
  View<uint32_t> round;
};

/// What one round works on.
struct State {
  VoxelSetView voxels;
  View<const PointQ8> position;
  View<const Neighbours> neighbours;
  View<LeafMask> done;  ///< labelled voxels
  View<uint32_t> label;
  View<uint32_t> due;  ///< round for which the leaf is listed
  Front front[2];      ///< by parity of the round
};

/// First labels: the best seed of each start voxel. Runs over the sorted starts.
struct Seat {
  State state;
  View<const Start> start;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t voxel = start[i].voxel;
    if (voxel < 0 || (i > 0 && start[i - 1].voxel == voxel)) return;
    state.label[voxel] = start[i].seed;
    const Voxel v = voxel_of_index(state.voxels, voxel);
    const uint32_t leaf = find_leaf(state.voxels, leaf_of_voxel(v));
    const int offset = offset_in_leaf(v);
    atomic_or(state.done[leaf].word[offset >> 6], uint64_t(1) << (offset & 63));
    state.front[0].round[leaf] = 0;
  }
};

struct HasSeat {
  State state;
  ISOSHELL_HD bool operator()(int64_t leaf) const { return state.front[0].round[leaf] == 0; }
};

/// Lists the leaves that the voxels of this round can reach, each once.
struct ListReached {
  State state;
  uint32_t round;
  View<const uint32_t> leaves;  ///< where the voxels of this round may be
  View<uint32_t> reached, count;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t leaf = leaves[i];
    const Front& front = state.front[round & 1];
    if (front.round[leaf] != round) return;
    const LeafMask& mask = front.mask[leaf];
    for (int n = 0; n < 27; ++n) {
      const uint32_t other = state.neighbours[leaf].leaf[n];
      if (other == kNone || !reaches(mask, n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1)) continue;
      if (atomic_max(state.due[other], round + 1)) reached[atomic_fetch_add(count[0], 1u)] = other;
    }
  }
};

/// Labels the voxels of one leaf that the round before touches.
struct Spread {
  State state;
  uint32_t round;
  View<const uint32_t> leaves;

  /// Labels of the round before in the leaf and one voxel around it, kNone elsewhere.
  struct Halo {
    uint32_t label[1000];
    ISOSHELL_HD static int at(int x, int y, int z) { return ((x + 1) * 10 + y + 1) * 10 + z + 1; }
  };

  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t leaf = leaves[i];
    const Front& before = state.front[~round & 1];
    const LeafMask* around[27];
    for (int n = 0; n < 27; ++n) {
      const uint32_t other = state.neighbours[leaf].leaf[n];
      around[n] = other != kNone && before.round[other] == round - 1 ? &before.mask[other] : nullptr;
    }
    LeafMask fresh = dilate_26(around);
    LeafMask& done = state.done[leaf];
    uint64_t any = 0;
    for (int w = 0; w < 8; ++w) any |= fresh.word[w] &= state.voxels.mask[leaf].word[w] & ~done.word[w];
    if (any == 0) return;
    const Front& now = state.front[round & 1];
    now.mask[leaf] = fresh;
    now.round[leaf] = round;
    for (int w = 0; w < 8; ++w) done.word[w] |= fresh.word[w];
    label_fresh(leaf, fresh, around);
  }

  ISOSHELL_HD void label_fresh(uint32_t leaf, const LeafMask& fresh, const LeafMask* const around[27]) const {
    Halo halo;
    for (uint32_t& l : halo.label) l = kNone;
    for (int n = 0; n < 27; ++n)
      if (around[n])
        read_neighbour(state.neighbours[leaf].leaf[n], *around[n], n / 9 - 1, n / 3 % 3 - 1, n % 3 - 1, halo);
    const Voxel at = leaf_of_key(state.voxels.leaf_key[leaf]);
    for (int x = 0; x < 8; ++x)
      for (uint64_t bits = fresh.word[x]; bits; bits &= bits - 1) {
        const int offset = x << 6 | lowest_bit(bits);
        const int64_t index = state.voxels.first[leaf] + rank_in_leaf(state.voxels.mask[leaf], offset);
        state.label[index] =
            best_around(halo, Halo::at(x, offset >> 3 & 7, offset & 7), voxel_centre(voxel_at(at, offset)));
      }
  }

  /// Labels of the neighbour's front voxels that touch the leaf.
  ISOSHELL_HD void read_neighbour(uint32_t other, const LeafMask& front, int dx, int dy, int dz, Halo& halo) const {
    for (int x = dx < 0 ? 7 : 0; x <= (dx > 0 ? 0 : 7); ++x)
      for (uint64_t bits = front.word[x] & touching(dy, dz); bits; bits &= bits - 1)
        read_voxel(other, x, lowest_bit(bits), dx, dy, dz, halo);
  }
  /// Voxels of a neighbour's slice that touch the leaf.
  ISOSHELL_HD static uint64_t touching(int dy, int dz) {
    uint64_t bits = ~uint64_t(0);
    if (dy != 0) bits &= dy < 0 ? 255ull << 56 : 255ull;
    if (dz != 0) bits &= dz < 0 ? 0x8080808080808080ull : 0x0101010101010101ull;
    return bits;
  }
  ISOSHELL_HD void read_voxel(uint32_t other, int x, int bit, int dx, int dy, int dz, Halo& halo) const {
    const int64_t index = state.voxels.first[other] + rank_in_leaf(state.voxels.mask[other], x << 6 | bit);
    halo.label[Halo::at(x + 8 * dx, (bit >> 3) + 8 * dy, (bit & 7) + 8 * dz)] = state.label[index];
  }

  ISOSHELL_HD uint32_t best_around(const Halo& halo, int middle, PointQ8 centre) const {
    uint32_t best = kNone;
    int64_t least = 0;
    for (int n = 0; n < 27; ++n) {
      const uint32_t seed = halo.label[middle + (n / 9 - 1) * 100 + (n / 3 % 3 - 1) * 10 + n % 3 - 1];
      if (seed == kNone || seed == best) continue;
      const int64_t d = distance_sq_q16(centre, state.position[seed]);
      if (best == kNone || d < least || (d == least && seed < best)) {
        least = d;
        best = seed;
      }
    }
    return best;
  }
};

}  // namespace flood

template <class Exec>
VoronoiLabels flood_shell_body(Exec& exec, const Shell& shell, const SeedSet& seeds) {
  using namespace flood;
  const VoxelSetView voxels = shell.voxels.view();
  const int64_t leaves = shell.voxels.leaf_count();
  VoronoiLabels out;
  out.voxel_seed = exec.template make<uint32_t>(shell.voxels.voxel_count());
  exec.fill(out.voxel_seed.view(), kNone);

  Buffer<Start> start = exec.template make<Start>(seeds.size());
  exec.for_each("find starts", seeds.size(), FindStart{voxels, seeds.position.view(), start.view()});
  exec.sort(start.view(), StartLess{});
  Buffer<Neighbours> neighbours = exec.template make<Neighbours>(leaves);
  exec.for_each("find neighbours", leaves, FindNeighbours{voxels, neighbours.view()});

  Buffer<LeafMask> done = exec.template make<LeafMask>(leaves), mask[2];
  Buffer<uint32_t> due = exec.template make<uint32_t>(leaves), round_of[2], list[2],
                   count = exec.template make<uint32_t>(1);
  State state{voxels, seeds.position.view(), neighbours.view(), done.view(), out.voxel_seed.view(), due.view(), {}};
  for (int parity = 0; parity < 2; ++parity) {
    mask[parity] = exec.template make<LeafMask>(leaves);
    round_of[parity] = exec.template make<uint32_t>(leaves);
    list[parity] = exec.template make<uint32_t>(leaves);
    exec.fill(round_of[parity].view(), kNone);
    state.front[parity] = {mask[parity].view(), round_of[parity].view()};
  }
  exec.fill(done.view(), LeafMask{});
  exec.fill(due.view(), uint32_t(0));
  exec.for_each("seat seeds", seeds.size(), Seat{state, start.view()});
  exec.copy(View<const LeafMask>(done.view()), mask[0].view());  // the voxels of round 0 are the first front

  const Buffer<uint32_t> seated = exec.select(leaves, HasSeat{state});
  View<const uint32_t> here = seated.view();
  for (uint32_t round = 0; here.size > 0; ++round) {
    const View<uint32_t> next = list[~round & 1].view();
    exec.fill(count.view(), uint32_t(0));
    exec.for_each("list reached leaves", here.size, ListReached{state, round, here, next, count.view()});
    here = {next.data, int64_t(exec.value(View<const uint32_t>(count.view()), 0))};
    exec.for_each("spread", here.size, Spread{state, round + 1, here});
  }
  return out;
}

}  // namespace isoshell
