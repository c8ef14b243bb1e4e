// Cooperative kernels of the dual's steps over disconnected pieces: a warp a disconnected piece, a lane a vertex of it.
#pragma once

#include "cuda/runtime/cooperative_kernel.cuh"
#include "stages/dual/dual_pieces_body.h"

namespace isoshell {
namespace pieces_cooperative {

struct NoShared {};
template <class Step>
struct CooperativePiece : CooperativeKernelOf<Step> {
  using Shared = NoShared;
};

__device__ inline PointQ8 middle(const dual::DisconnectedPiecesView& disconnected_pieces, int64_t s,
                                 View<const PointQ8> position, int lane) {
  Vec64 sum = {0, 0, 0};
  for (int64_t m = disconnected_pieces.first[s] + lane; m < disconnected_pieces.first[s + 1]; m += 32) {
    const PointQ8 p = position[disconnected_pieces.vertex(m)];
    sum = sum + Vec64{p.x, p.y, p.z};
  }
  const int64_t count = disconnected_pieces.first[s + 1] - disconnected_pieces.first[s];
  return {int32_t(round_div(warp_sum(sum.x), count)), int32_t(round_div(warp_sum(sum.y), count)),
          int32_t(round_div(warp_sum(sum.z), count))};
}

/// Smallest (distance, index) of the warp.
struct Nearest {
  int64_t distance = INT64_MAX;
  uint32_t index = kNone;
  __device__ void offer(int64_t d, uint32_t i) {
    if (d < distance || (d == distance && i < index)) distance = d, index = i;
  }
  __device__ void over_warp() { warp_min_pair(distance, index); }
};

}  // namespace pieces_cooperative

template <>
struct CooperativeKernel<dual::DecideDisconnectedPiece>
    : pieces_cooperative::CooperativePiece<dual::DecideDisconnectedPiece> {
  static __device__ void run(const dual::DecideDisconnectedPiece& step, int64_t i, Shared&, int lane) {
    const dual::DisconnectedPiecesView& disconnected_pieces = step.disconnected_pieces;
    const int64_t s = step.waiting[i], size = disconnected_pieces.first[s + 1] - disconnected_pieces.first[s];
    const uint32_t root = disconnected_pieces.root[s];
    const uint32_t copy = copy_beside(step, s, step.label[root], lane);
    if (copy != kNone || 4 * size * step.mean_cells > step.mean_vertices) {
      if (lane == 0) step.decision[i] = copy != kNone ? copy : dual::kNewCell;
      return;
    }
    const uint64_t rank = dual::piece_rank(step.piece_size[root], root);
    const PointQ8 middle = pieces_cooperative::middle(disconnected_pieces, s, step.vertex_position, lane);
    pieces_cooperative::Nearest nearest;
    bool largest = true;
    for (int64_t m = disconnected_pieces.first[s] + lane; m < disconnected_pieces.first[s + 1]; m += 32)
      step.graph.for_each_neighbour(disconnected_pieces.vertex(m), [&](uint32_t w) {
        const uint32_t other = step.piece[w];
        if (other == root) return;
        const uint32_t owner = step.label[w];
        if (step.main_root[owner] != other)
          largest = largest && dual::piece_rank(step.piece_size[other], other) < rank;
        else
          nearest.offer(distance_sq_q16(middle, step.seed_position[owner]), owner);
      });
    nearest.over_warp();
    largest = __all_sync(kWholeWarp, largest);
    if (lane == 0)
      step.decision[i] = nearest.index != kNone ? nearest.index : (largest ? dual::kLocalLargest : dual::kWait);
  }

 private:
  static __device__ uint32_t copy_beside(const dual::DecideDisconnectedPiece& step, int64_t s, uint32_t own, int lane) {
    uint32_t found = kNone;
    if (own >= step.joined.size) return found;
    for (int64_t m = step.disconnected_pieces.first[s] + lane; m < step.disconnected_pieces.first[s + 1]; m += 32)
      step.graph.for_each_neighbour(step.disconnected_pieces.vertex(m),
                                    [&](uint32_t w) { found = min(found, step.copy_at(w, own)); });
    return warp_min(found);
  }
};

template <>
struct CooperativeKernel<dual::JoinDisconnectedPiece>
    : pieces_cooperative::CooperativePiece<dual::JoinDisconnectedPiece> {
  static __device__ void run(const dual::JoinDisconnectedPiece& step, int64_t i, Shared&, int lane) {
    const int64_t s = step.waiting[step.index[i]], first = step.disconnected_pieces.first[s],
                  end = step.disconnected_pieces.first[s + 1];
    const uint32_t owner = step.decision[step.index[i]], root = step.cells.root[owner];
    for (int64_t m = first + lane; m < end; m += 32) {
      step.label[step.disconnected_pieces.vertex(m)] = owner;
      step.piece[step.disconnected_pieces.vertex(m)] = root;
    }
    if (lane == 0) atomic_add(step.cells.size[owner], uint32_t(end - first));
  }
};

template <>
struct CooperativeKernel<dual::FoundCell> : pieces_cooperative::CooperativePiece<dual::FoundCell> {
  static __device__ void run(const dual::FoundCell& step, int64_t i, Shared&, int lane) {
    const int64_t s = step.waiting[step.index[i]], first = step.disconnected_pieces.first[s],
                  end = step.disconnected_pieces.first[s + 1];
    const PointQ8 middle = pieces_cooperative::middle(step.disconnected_pieces, s, step.seeds.vertex_position, lane);
    const uint32_t id = step.new_id[i];
    pieces_cooperative::Nearest nearest;
    for (int64_t m = first + lane; m < end; m += 32) {
      const uint32_t v = step.disconnected_pieces.vertex(m);
      nearest.offer(distance_sq_q16(middle, step.seeds.vertex_position[v]), v);
      step.label[v] = id;
    }
    nearest.over_warp();
    if (lane != 0) return;
    step.cells.root[id] = step.disconnected_pieces.root[s];
    step.cells.size[id] = uint32_t(end - first);
    step.seeds.put(id, nearest.index);
  }
};

}  // namespace isoshell
