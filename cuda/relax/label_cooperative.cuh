// Cooperative kernel of the step that labels a sheet: a warp a block. Lanes gather the seeds near the block, then label
// its vertices.
#pragma once

#include "cuda/runtime/cooperative_kernel.cuh"
#include "stages/labels/label_body.h"

namespace isoshell {
namespace label_cooperative {

constexpr int kCapacity = 128;  ///< seeds of a block; more take the exact slow path

struct Candidates {
  label::LabelSeed seed[kCapacity];
};

/// One block and the warp that labels it.
class BlockLabeller {
 public:
  __device__ BlockLabeller(const label::LabelBlock<>& step, int64_t block, Candidates& candidates, int lane)
      : step_(step),
        candidates_(candidates),
        lane_(lane),
        begin_(step.blocks.first[block]),
        end_(step.blocks.first[block + 1]),
        patch_(step.patches.at(begin_)) {}

  /// Looks among the seeds within reach of the block's bounds. When the dearest label costs no more than a seed beyond
  /// would, the labels are right; else that cost says how far to look.
  __device__ void run() {
    find_bounds();
    const int64_t h_q8 = step_.spacing.h_at(uint32_t(begin_));
    int64_t reach_sq = h_q8 * h_q8;
    for (;;) {
      const int count = gather(reach_sq);
      int64_t dearest = 0;
      for (int64_t v = begin_ + lane_; v < end_; v += 32) {
        const Best best = count <= kCapacity ? best_of(v, count) : best_within(v, reach_sq);
        dearest = best.cost > dearest ? best.cost : dearest;
        step_.out[v] = best.id;
      }
      dearest = warp_max(dearest);
      if (dearest <= reach_sq) return;
      reach_sq = dearest == INT64_MAX ? 4 * reach_sq : dearest;  // no seed at all, or none near enough
      __syncwarp();
    }
  }

 private:
  __device__ void find_bounds() {
    label::Bounds b = label::empty_bounds();
    for (int64_t v = begin_ + lane_; v < end_; v += 32) include(b, step_.position[v], step_.normal[v]);
    const auto all = [](auto& lo, auto& hi) {
      lo = warp_min(int(lo));
      hi = warp_max(int(hi));
    };
    all(b.lo.x, b.hi.x);
    all(b.lo.y, b.hi.y);
    all(b.lo.z, b.hi.z);
    all(b.normal_lo.x, b.normal_hi.x);
    all(b.normal_lo.y, b.normal_hi.y);
    all(b.normal_lo.z, b.normal_hi.z);
    bounds_ = b;
  }

  /// Keeps the seeds of the patch within reach, perhaps others of it too. Returns their number; above kCapacity they do
  /// not fit.
  __device__ int gather(int64_t reach_sq) {
    int count = 0;
    for_each_within(reach_sq, [&](bool in, const label::LabelSeed& s) {
      in = in && step_.patches.has(patch_, s.id) &&
           cost_range(bounds_, s.position, s.normal, step_.spacing.penalty_q16).lo <= reach_sq;
      const unsigned kept = __ballot_sync(kWholeWarp, in);
      const int place = count + lanes_before(kept);
      if (in && place < kCapacity) candidates_.seed[place] = s;
      count += __popc(kept);
    });
    __syncwarp();
    return count;
  }

  /// Calls visit(in, seed) in all lanes alike, `in` where there is a seed, for those of a box around the bounds.
  template <class Visit>
  __device__ void for_each_within(int64_t limit_sq, Visit visit) const {
    const PointGridView& grid = step_.grid;
    const int32_t r = int32_t(isqrt(uint64_t(limit_sq))) + 1;
    const int32_t x_lo = grid_coordinate(grid, bounds_.lo.x - r, 0), x_hi = grid_coordinate(grid, bounds_.hi.x + r, 0),
                  y_lo = grid_coordinate(grid, bounds_.lo.y - r, 1), y_hi = grid_coordinate(grid, bounds_.hi.y + r, 1),
                  z_lo = grid_coordinate(grid, bounds_.lo.z - r, 2), z_hi = grid_coordinate(grid, bounds_.hi.z + r, 2);
    const int32_t across = y_hi - y_lo + 1, rows = (x_hi - x_lo + 1) * across;
    for (int32_t base = 0; base < rows; base += 32) {
      const int32_t row = base + lane_;
      uint32_t i = 0, end = 0;
      if (row < rows) {
        const int64_t cell = grid_cell(grid, x_lo + row / across, y_lo + row % across, z_lo);
        i = grid.cell_first[cell];
        end = grid.cell_first[cell + (z_hi - z_lo) + 1];
      }
      for (; __any_sync(kWholeWarp, i < end); ++i) {
        label::LabelSeed s{};
        if (i < end) {
          const GridPoint p = grid.points[i];
          s = {p.position, p.id, step_.seed_normal[p.id]};
        }
        visit(i < end, s);
      }
    }
  }

  struct Best {
    int64_t cost = INT64_MAX;
    uint32_t id = kNone;
    __device__ void offer(int64_t c, uint32_t seed) {
      if (c < cost || (c == cost && seed < id)) cost = c, id = seed;
    }
  };
  __device__ Best best_of(int64_t v, int count) const {
    Best best;
    const PointQ8 p = step_.position[v];
    const Normal8 n = step_.normal[v];
    for (int c = 0; c < count; ++c)
      best.offer(label::cost(p, n, candidates_.seed[c], step_.spacing.penalty_q16), candidates_.seed[c].id);
    return best;
  }
  /// The exact path without a list.
  __device__ Best best_within(int64_t v, int64_t reach_sq) const {
    Best best;
    const int32_t r = int32_t(isqrt(uint64_t(reach_sq))) + 1;
    const PointQ8 lo = bounds_.lo, hi = bounds_.hi;
    const auto offer = [&](const GridPoint& p) {
      if (!step_.patches.has(patch_, p.id)) return;
      best.offer(label::cost(step_.position[v], step_.normal[v], {p.position, p.id, step_.seed_normal[p.id]},
                             step_.spacing.penalty_q16),
                 p.id);
    };
    visit_box(step_.grid, {{lo.x - r, lo.y - r, lo.z - r}, {hi.x + r, hi.y + r, hi.z + r}}, offer);
    return best;
  }

  const label::LabelBlock<>& step_;
  Candidates& candidates_;
  const int lane_;
  const int64_t begin_, end_;
  const uint32_t patch_;  ///< of the surface
  label::Bounds bounds_;
};

}  // namespace label_cooperative

template <>
struct CooperativeKernel<label::LabelBlock<>> : CooperativeKernelOf<label::LabelBlock<>> {
  using Shared = label_cooperative::Candidates;
  static __device__ void run(const label::LabelBlock<>& step, int64_t block, Shared& candidates, int lane) {
    label_cooperative::BlockLabeller(step, block, candidates, lane).run();
  }
};

}  // namespace isoshell
