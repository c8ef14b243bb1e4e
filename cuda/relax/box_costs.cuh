// What a seed costs over the box of a patch, at least and at most: the bounds that keep seeds out of lists.
#pragma once

#include "cuda/relax/seed_buckets.cuh"
#include "cuda/relax/sheet_patches.cuh"
#include "cuda/runtime/warp.cuh"

namespace isoshell::cuda_relax {

/// What a search knows of a patch, from its origin.
struct PatchBox {
  PointQ8 origin;
  Local lo, hi;
  uint32_t normal_lo, normal_hi;   ///< packed
  uint32_t surface_patch = kNone;  ///< whose seeds count, where the surface is cut

  /// How far a seed is outside the box, on each axis.
  __device__ Local outside(const SeedRecord& s) const {
    const auto axis = [](int32_t lo, int32_t hi, int32_t d) { return max(max(lo - d, d - hi), 0); };
    return {axis(lo.x, hi.x, s.x - origin.x), axis(lo.y, hi.y, s.y - origin.y), axis(lo.z, hi.z, s.z - origin.z)};
  }
  __device__ int32_t extent() const { return max(max(hi.x - lo.x, hi.y - lo.y), hi.z - lo.z); }
  __device__ bool near() const { return within(lo, kMaxLocal) && within(hi, kMaxLocal); }
  __device__ static bool within(Local u, int32_t limit) {
    return u.x > -limit && u.x < limit && u.y > -limit && u.y < limit && u.z > -limit && u.z < limit;
  }
};
__device__ inline PatchBox box_of(const Patch& patch) {
  const PatchBounds b = patch.bounds;
  return {b.origin,    {b.lo[0], b.lo[1], b.lo[2]}, {b.hi[0], b.hi[1], b.hi[2]}, b.normal_lo,
          b.normal_hi, patch.surface_patch};
}

/// Root of a squared distance in q16, rounded up, perhaps by a little more.
__device__ inline int32_t reach_of(int64_t sq_q16) { return int32_t(sqrtf(float(sq_q16)) * 1.00001f) + 1; }

/// Smallest and largest cost of a seed over the box. Cost is uint32_t, which holds them while reach and box are short
/// (see fits), or int64_t; `none` stands for what it does not hold.
template <class Cost>
struct CostBounds {
  static constexpr Cost none() { return sizeof(Cost) == 4 ? Cost(UINT32_MAX) : Cost(INT64_MAX); }
  Cost lo, hi;
  Cost far;  ///< largest squared distance
  bool may_oppose, always_opposes;
};

template <class Cost>
class BoxCosts {
 public:
  __device__ BoxCosts(const PatchBox& box, int64_t penalty_q16)
      : box_(box),
        half_(normal_half(box)),
        penalty_(sizeof(Cost) == 8 || penalty_q16 < UINT32_MAX ? Cost(penalty_q16) : CostBounds<Cost>::none()),
        full_penalty_(penalty_q16) {}

  /// Farther than `reach` on an axis: out of the question, and perhaps out of range.
  __device__ CostBounds<Cost> of(const SeedRecord& s, int32_t reach) const {
    const Local d = {s.x - box_.origin.x, s.y - box_.origin.y, s.z - box_.origin.z};
    const auto outside = [](int32_t lo, int32_t hi, int32_t d) { return max(max(lo - d, d - hi), 0); };
    const int32_t x = outside(box_.lo.x, box_.hi.x, d.x), y = outside(box_.lo.y, box_.hi.y, d.y),
                  z = outside(box_.lo.z, box_.hi.z, d.z);
    constexpr Cost kNothing = CostBounds<Cost>::none();
    if (max(max(x, y), z) > reach) return {kNothing, kNothing, kNothing, false, false};
    const auto far = [](int32_t lo, int32_t hi, int32_t d) { return max(d - lo, hi - d); };
    CostBounds<Cost> out{};
    out.lo = sum_of_squares(x, y, z);
    out.hi = out.far =
        sum_of_squares(far(box_.lo.x, box_.hi.x, d.x), far(box_.lo.y, box_.hi.y, d.y), far(box_.lo.z, box_.hi.z, d.z));
    if (penalty_ == 0) return out;
    // Twice the dot product at the middle of the normals' box, and how far it goes both ways.
    const int32_t middle =
        __dp4a(int(s.packed_normal), int(box_.normal_lo), 0) + __dp4a(int(s.packed_normal), int(box_.normal_hi), 0);
    const int32_t spread = int32_t(__dp4a(__vabs4(s.packed_normal), half_, 0u));
    out.may_oppose = middle - spread < 2 * label::kOpposite;
    if (out.may_oppose) out.hi = plus_penalty(out.hi);
    out.always_opposes = middle + spread < 2 * label::kOpposite;
    if (out.always_opposes) out.lo = plus_penalty(out.lo);
    return out;
  }

  /// Reaches that Cost can work with.
  __device__ static bool fits(const PatchBox& box, int32_t reach) {
    return sizeof(Cost) == 8 || (box.near() && reach + box.extent() < 1 << 15);
  }

  /// True when `best`, which is at `m`, wins against the seed at every point of the box, penalties counted.
  __device__ bool beaten(const SeedRecord& best, uint32_t best_id, bool best_may_pay, const SeedRecord& s, uint32_t id,
                         bool always_pays) const {
    const auto axis = [](int32_t origin, int32_t lo, int32_t hi, int32_t pa, int32_t pb) {
      const int64_t v = pb > pa ? hi : lo, a = pa - origin, b = pb - origin;
      return (b - a) * (2 * v - a - b);
    };
    int64_t most = axis(box_.origin.x, box_.lo.x, box_.hi.x, best.x, s.x) +
                   axis(box_.origin.y, box_.lo.y, box_.hi.y, best.y, s.y) +
                   axis(box_.origin.z, box_.lo.z, box_.hi.z, best.z, s.z);
    if (best_may_pay) most += full_penalty_;
    if (always_pays) most -= full_penalty_;
    return most < 0 || (most == 0 && best_id < id);
  }

 private:
  __device__ static uint32_t normal_half(const PatchBox& box) {
    uint32_t out = 0;
    for (int shift = 0; shift < 24; shift += 8)
      out |= uint32_t(int8_t(box.normal_hi >> shift) - int8_t(box.normal_lo >> shift)) << shift;
    return out;
  }
  __device__ static Cost sum_of_squares(int32_t x, int32_t y, int32_t z) {
    return Cost(x) * Cost(x) + Cost(y) * Cost(y) + Cost(z) * Cost(z);
  }
  __device__ Cost plus_penalty(Cost c) const {
    return c > CostBounds<Cost>::none() - penalty_ ? CostBounds<Cost>::none() : c + penalty_;
  }

  const PatchBox& box_;
  const uint32_t half_;
  const Cost penalty_;
  const int64_t full_penalty_;
};

}  // namespace isoshell::cuda_relax
