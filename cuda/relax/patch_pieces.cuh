// Pieces of a patch's triangles: voxel/cell_sum.h in short numbers (voxel/cell_sum_32.h), which its vertices and areas
// allow (see make_sheet_patches): positions below 2^13, areas below 2^28.
#pragma once

#include "cuda/relax/box_costs.cuh"
#include "stages/relax/relax_sheet_body.h"
#include "voxel/cell_sum_32.h"

namespace isoshell::cuda_relax {

namespace in_patch {

__device__ inline PieceSum piece_sum32(int32_t area2, Local a, Local b, Local c) {
  const Local sum = corner_sum(a, b, c);
  return {area2, int64_t(area2) * sum.x, int64_t(area2) * sum.y, int64_t(area2) * sum.z,
          int64_t(uint64_t(uint32_t(area2)) * sum_of_squares_32(a, b, c))};
}

/// The correctly rounded quotient of numbers between 1 and 2^60: the steps of a / b where it need not look for others.
__device__ inline float divide(float a, float b) {
  float r;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(r) : "f"(b));
  r = __fmaf_rn(r, __fmaf_rn(-b, r, 1), r);
  float q = __fmul_rn(a, r);
  q = __fmaf_rn(r, __fmaf_rn(-b, q, a), q);
  return __fmaf_rn(r, __fmaf_rn(-b, q, a), q);
}

__device__ inline int32_t crossing32(int64_t here, int64_t there) {
  const float h = float(-here), t = float(there);
  const int32_t between = int32_t(float(kOneQ15) * divide(h, h + t));
  return here >= 0 ? 0 : there <= 0 ? kOneQ15 : between;
}

/// The corner p of the triangle (p, q, r) on the side of `here` of the bisector with `other`.
__device__ inline PieceSum corner_piece32(int32_t area2, Local p, Local q, Local r, Local here, Local other) {
  const int64_t at = bisector_value(p, here, other);
  const int32_t t = crossing32(at, bisector_value(q, here, other)), u = crossing32(at, bisector_value(r, here, other));
  return piece_sum32(part_of(uint32_t(area2), t * u >> 15), p, between_32(p, q, t), between_32(p, r, u));
}

/// A triangle whose corners are three seeds', from one of them on.
struct Junction {
  Local p[3], s[3];

  /// SplitTriangle::separates(0).
  __device__ bool separates() const {
    const Local m =
        between_32(p[1], p[2], crossing32(bisector_value(p[1], s[1], s[2]), bisector_value(p[2], s[1], s[2])));
    return bisector_value(m, s[1], s[0]) > 0 && bisector_value(m, s[2], s[0]) > 0;
  }
};

/// One of three by its number.
template <class T>
__device__ inline T pick(int i, T a, T b, T c) {
  return i == 0 ? a : i == 1 ? b : c;
}
__device__ inline Local pick(int i, Local a, Local b, Local c) {
  return {pick(i, a.x, b.x, c.x), pick(i, a.y, b.y, c.y), pick(i, a.z, b.z, c.z)};
}

/// Energy of sums moved to a seed at d, as relax_sheet::add_to_cell gives it, where that is known to stay in 64 bits.
__device__ inline bool is_modest(const PieceSum& s, Local d) {
  constexpr int64_t kFirst = int64_t(1) << 42;
  const auto modest = [](int64_t first) { return uint64_t(first + kFirst) < uint64_t(2 * kFirst); };
  return PatchBox::within(d, 1 << 14) && uint64_t(s.mass) < 1u << 28 && modest(s.first_x) && modest(s.first_y) &&
         modest(s.first_z) && uint64_t(s.second) < uint64_t(1) << 60;
}

/// atomic_add in device memory without an answer to wait for.
__device__ inline void add_unread(int64_t& target, int64_t value) {
  asm volatile("red.relaxed.gpu.global.add.u64 [%0], %1;" ::"l"(__cvta_generic_to_global(&target)), "l"(value)
               : "memory");
}

__device__ __noinline__ inline Int128 add_far(relax_sheet::CellSum& cell, const PieceSum& s, Local d) {
  return relax_sheet::add_to_cell(cell, s, d);
}

__device__ inline Int128 add_to_cell(relax_sheet::CellSum& cell, const PieceSum& s, Local d) {
  if (!is_modest(s, d)) return add_far(cell, s, d);
  const int32_t mass = int32_t(s.mass);
  add_unread(cell.mass, s.mass);
  add_unread(cell.first_x, s.first_x - int64_t(mass) * (3 * d.x));
  add_unread(cell.first_y, s.first_y - int64_t(mass) * (3 * d.y));
  add_unread(cell.first_z, s.first_z - int64_t(mass) * (3 * d.z));
  return s.second - 8 * (s.first_x * d.x + s.first_y * d.y + s.first_z * d.z) +
         12 * (int64_t(mass) * int32_t(square_32(d)));
}

}  // namespace in_patch

}  // namespace isoshell::cuda_relax
