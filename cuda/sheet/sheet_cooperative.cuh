// Cooperative kernels of build_sheet's steps over leaves: a warp a leaf.
#pragma once

#include "cuda/sparse/leaf_cooperative.cuh"
#include "stages/sheet/sheet_body.h"

namespace isoshell {
namespace leaf_cooperative {

/// A leaf with the voxels around it in shared memory, and what it takes to load it.
struct WarpWindow {
  SolidWindow window;
  const uint64_t* words[27];
  uint64_t uniform[27];
};

/// load_window by a warp. Returns is_mixed.
__device__ inline bool load_window(const SolidView& solid, Voxel leaf, WarpWindow& to, int lane) {
  if (lane < 27) {
    const SolidLeaf near = solid.at(neighbour_leaf(leaf, lane));
    to.words[lane] = near.words;
    to.uniform[lane] = near.uniform;
  }
  __syncwarp();
  uint32_t any = 0, all = kWindowRow;
  for (int r = lane; r < 100; r += 32) {
    const int x = r / 10 + 7, y = r % 10 + 7;  // leaf coordinate + 8
    const int column = (x >> 3) * 9 + (y >> 3) * 3;
    const auto byte = [&](int n) {
      const uint64_t word = to.words[n] ? to.words[n][x & 7] : to.uniform[n];
      return uint32_t(word >> (8 * (y & 7))) & 255;
    };
    const uint32_t row = byte(column) >> 7 | byte(column + 1) << 1 | (byte(column + 2) & 1) << 9;
    to.window.row[r / 10][r % 10] = row;
    any |= row;
    all &= row;
  }
  any = warp_or(any);
  all = warp_and(all);
  __syncwarp();
  return any != 0 && all != kWindowRow;
}

struct WindowAndAdditions {
  WarpWindow window;
  WindowAdditions add;
  unsigned long long added[8];
};

struct WindowAndOffsets {
  WarpWindow window;
  uint16_t offset[512];
};

/// The words of some leaves, and the index of the first vertex of every word.
template <int kLeaves>
struct RankedLeaves {
  uint32_t first[kLeaves][8];
  uint64_t word[kLeaves][8];

  /// Of the leaves leaf_at(0), leaf_at(1), ..., which may be missing. By a whole warp.
  template <class LeafAt>
  __device__ void load(const VoxelSetView& set, int lane, LeafAt leaf_at) {
    if (lane < kLeaves) {
      const uint32_t leaf = find_leaf(set, leaf_at(lane));
      uint32_t at = leaf == kNone ? 0 : uint32_t(set.first[leaf]);
      for (int w = 0; w < 8; ++w) {
        const uint64_t bits = leaf == kNone ? 0 : set.mask[leaf].word[w];
        word[lane][w] = bits;
        first[lane][w] = at;
        at += uint32_t(popcount64(bits));
      }
    }
    __syncwarp();
  }
  /// Of the vertex at (x, y, z) modulo 8 in leaf n.
  __device__ uint32_t index(int n, int x, int y, int z) const {
    const uint64_t below = (uint64_t(1) << ((y & 7) << 3 | (z & 7))) - 1;
    return first[n][x & 7] + uint32_t(popcount64(word[n][x & 7] & below));
  }
};

/// CornerLookup with the ranks of all words at hand.
struct WarpCornerLookup {
  WarpWindow window;
  RankedLeaves<8> leaves;

  __device__ void load(const VoxelSetView& set, Voxel l, int lane) {
    leaves.load(set, lane, [&](int n) { return Voxel{l.x + (n >> 2), l.y + (n >> 1 & 1), l.z + (n & 1)}; });
  }
  __device__ uint32_t operator()(int x, int y, int z) const {
    return leaves.index((x >> 3) << 2 | (y >> 3) << 1 | z >> 3, x, y, z);
  }
};

/// Vertex indices on the other side of a leaf's faces, with the ranks of all words at hand.
struct FaceNeighbours {
  uint16_t offset[512];
  RankedLeaves<7> leaves;  ///< the leaf itself, then through each face

  __device__ void load(const VoxelSetView& set, Voxel l, int lane) {
    leaves.load(set, lane, [&](int n) { return n == 0 ? l : step_through(l, n - 1); });
  }
  __device__ uint32_t vertex_through(int face, int from) const {
    const Voxel to = step_through({from >> 6, from >> 3 & 7, from & 7}, face);
    const bool inside = ((to.x | to.y | to.z) & ~7) == 0;
    return leaves.index(inside ? 0 : 1 + face, to.x, to.y, to.z);
  }
};

}  // namespace leaf_cooperative

template <>
struct CooperativeKernel<sheet_steps::FindAdditions>
    : leaf_cooperative::CooperativeLeaf<sheet_steps::FindAdditions, leaf_cooperative::WindowAndAdditions> {
  static __device__ void run(const sheet_steps::FindAdditions& step, int64_t i, Shared& shared, int lane) {
    const Voxel l = leaf_of_key(step.solid.set.leaf_key[step.list[i]]);
    if (!leaf_cooperative::load_window(step.solid, l, shared.window, lane)) {
      if (lane < 8) step.added[i].word[lane] = 0;
      return;
    }
    for (int r = lane; r < 100; r += 32) shared.add.row[r / 10][r % 10] = 0;
    if (lane < 8) shared.added[lane] = 0;
    __syncwarp();
    const auto add = [&](int x, int y, uint32_t bits) {
      if (bits) atomicOr(&shared.add.row[x][y], bits);
    };
    for (int r = lane; r < 100; r += 32) find_additions_at(shared.window.window, r / 10, r % 10, add);
    __syncwarp();
    uint32_t reached = 0;
    for (int r = lane; r < 100; r += 32) {
      const int x = r / 10, y = r % 10;
      const uint32_t row = shared.add.row[x][y];
      if (!row) continue;
      const int dx = (x + 7) / 8 - 1, dy = (y + 7) / 8 - 1;
      if (dx == 0 && dy == 0) atomicOr(&shared.added[x - 1], (unsigned long long)(row >> 1 & 255) << (8 * (y - 1)));
      if (row & 1) reached |= 1u << neighbour_number(dx, dy, -1);
      if (row & 0x1fe) reached |= 1u << neighbour_number(dx, dy, 0);
      if (row >> 9) reached |= 1u << neighbour_number(dx, dy, 1);
    }
    reached = warp_or(reached);
    __syncwarp();
    if (lane < 8) step.added[i].word[lane] = shared.added[lane];
    if (lane == 0 && reached) step.wanted[step.list[i]] = sheet_steps::without_mask(step.solid, l, reached);
  }
};

template <>
struct CooperativeKernel<sheet_steps::WantCornerLeaves>
    : leaf_cooperative::CooperativeLeaf<sheet_steps::WantCornerLeaves, leaf_cooperative::WarpWindow> {
  static __device__ void run(const sheet_steps::WantCornerLeaves& step, int64_t i, Shared& shared, int lane) {
    const Voxel l = leaf_of_key(step.solid.set.leaf_key[i]);
    uint32_t want = 0;
    if (leaf_cooperative::load_window(step.solid, l, shared, lane))
      for (int r = lane; r < 81; r += 32) {
        const int x = r / 9, y = r % 9;
        const uint32_t row = sheet_steps::corner_row(shared.window, x, y);
        if (row & 255 && (x == 8 || y == 8)) want |= 1u << neighbour_number(x / 8, y / 8, 0);
        if (row >> 8) want |= 1u << neighbour_number(x / 8, y / 8, 1);
      }
    want = warp_or(want);
    if (lane == 0) step.wanted[i] = sheet_steps::without_mask(step.solid, l, want);
  }
};

template <>
struct CooperativeKernel<sheet_steps::MarkCorners>
    : leaf_cooperative::CooperativeLeaf<sheet_steps::MarkCorners, leaf_cooperative::WarpWindow> {
  static __device__ void run(const sheet_steps::MarkCorners& step, int64_t i, Shared& shared, int lane) {
    const Voxel l = leaf_of_key(step.solid.set.leaf_key[i]);
    const bool mixed = leaf_cooperative::load_window(step.solid, l, shared, lane);
    if (lane >= 8) return;
    uint64_t word = 0;
    if (mixed)
      for (int y = 0; y < 8; ++y) word |= uint64_t(sheet_steps::corner_row(shared.window, lane, y) & 255) << (8 * y);
    step.mask[i].word[lane] = word;
  }
};

template <>
struct CooperativeKernel<sheet_steps::DescribeCorners>
    : leaf_cooperative::CooperativeLeaf<sheet_steps::DescribeCorners, leaf_cooperative::WindowAndOffsets> {
  static __device__ void run(const sheet_steps::DescribeCorners& step, int64_t i, Shared& shared, int lane) {
    const Voxel l = leaf_of_key(step.corners.leaf_key[i]);
    leaf_cooperative::load_window(step.solid, l, shared.window, lane);
    const int count = leaf_cooperative::list_active(step.corners.mask[i], shared.offset, lane);
    const int64_t first = step.corners.first[i];
    for (int k = lane; k < count; k += 32) step.describe(shared.window.window, l, shared.offset[k], first + k);
  }
};

template <>
struct CooperativeKernel<sheet_steps::CountFaces>
    : leaf_cooperative::CooperativeLeaf<sheet_steps::CountFaces, leaf_cooperative::WarpWindow> {
  static __device__ void run(const sheet_steps::CountFaces& step, int64_t i, Shared& shared, int lane) {
    int faces = 0;
    if (leaf_cooperative::load_window(step.solid, leaf_of_key(step.solid.set.leaf_key[i]), shared, lane))
      for (int r = lane; r < 64; r += 32) {
        uint32_t exposed[6];
        sheet_steps::exposed_faces(shared.window, r >> 3, r & 7, exposed);
        for (const uint32_t e : exposed) faces += __popc(e);
      }
    faces = warp_sum(faces);
    if (lane == 0) step.count[i] = faces;
  }
};

/// Lanes take the rows (x, y) in pairs, so that their quads follow each other in order.
template <>
struct CooperativeKernel<sheet_steps::ListFaces>
    : leaf_cooperative::CooperativeLeaf<sheet_steps::ListFaces, leaf_cooperative::WarpCornerLookup> {
  static __device__ void run(const sheet_steps::ListFaces& step, int64_t i, Shared& shared, int lane) {
    if (step.first[i + 1] == step.first[i]) return;
    const Voxel l = leaf_of_key(step.solid.set.leaf_key[i]);
    leaf_cooperative::load_window(step.solid, l, shared.window, lane);
    shared.load(step.corners, l, lane);
    uint32_t exposed[2][6], faces = 0;
    for (int k = 0; k < 2; ++k) {
      sheet_steps::exposed_faces(shared.window.window, (2 * lane + k) >> 3, (2 * lane + k) & 7, exposed[k]);
      for (const uint32_t e : exposed[k]) faces += uint32_t(__popc(e));
    }
    int64_t at = step.first[i] + warp_sum_before(faces);
    for (int k = 0; k < 2; ++k)
      sheet_steps::ListFaces::list_row(shared, (2 * lane + k) >> 3, (2 * lane + k) & 7, exposed[k], step.quads, at);
  }
};

template <>
struct CooperativeKernel<sheet_steps::SmoothCorners>
    : leaf_cooperative::CooperativeLeaf<sheet_steps::SmoothCorners, leaf_cooperative::FaceNeighbours> {
  static __device__ void run(const sheet_steps::SmoothCorners& step, int64_t i, Shared& shared, int lane) {
    shared.load(step.corners, leaf_of_key(step.corners.leaf_key[i]), lane);
    const int count = leaf_cooperative::list_active(step.corners.mask[i], shared.offset, lane);
    const int64_t first = step.corners.first[i];
    for (int k = lane; k < count; k += 32) {
      const uint8_t edges = step.edges[first + k];
      PointQ8 sum = {0, 0, 0};
      for (int f = 0; f < 6; ++f)
        if (edges >> f & 1) sum = sheet_steps::sum_of(sum, step.from[shared.vertex_through(f, shared.offset[k])]);
      step.to[first + k] = sheet_steps::mean_of(sum, __popc(edges));
    }
  }
};

}  // namespace isoshell
