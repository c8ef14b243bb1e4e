// WalkOntoSheet of stages/sheet_walk.h by eight lanes a seed: the triangles around a vertex are looked at side by side,
// and those of the last vertex are still in registers when the closest point on them is wanted.
#pragma once

#include "stages/sheet_walk.h"

namespace isoshell::cuda_relax {

constexpr int kWalkLanes = 8;

/// Where a walk ends: its vertex, and the closest point to the target around that.
struct Landing {
  uint32_t vertex;
  PointQ8 point;
};

/// All lanes of the warp call it; those of a group with the same arguments.
__device__ inline Landing walk_together(const WalkOntoSheet& sheet, uint32_t from, PointQ8 target, bool active) {
  const int lane = threadIdx.x & (kWalkLanes - 1);
  Landing at{from, sheet.position[from]};
  int64_t best = distance_sq_q16(at.point, target), begin = 0, end = 0;
  PointQ8 a{}, b{}, c{};
  const auto load = [&](int64_t n) {
    const TriangleIndices t = sheet.triangles[sheet.vertex_triangles[n]];
    a = sheet.position[t.a], b = sheet.position[t.b], c = sheet.position[t.c];
    return t;
  };
  for (bool walking = active; __any_sync(~0u, walking);) {
    int64_t least = best;
    uint32_t next = at.vertex;
    if (walking) {
      begin = sheet.vertex_first[at.vertex], end = sheet.vertex_first[at.vertex + 1];
      const auto consider = [&](PointQ8 p, uint32_t v) {
        const int64_t d = distance_sq_q16(p, target);
        if (d < least || (d == least && v < next)) least = d, next = v;
      };
      // The lane's first triangle comes last, and stays in the registers.
      for (int64_t n = begin + lane + (end - begin - lane - 1) / kWalkLanes * kWalkLanes; n >= begin + lane && n < end;
           n -= kWalkLanes) {
        const TriangleIndices t = load(n);
        consider(a, t.a), consider(b, t.b), consider(c, t.c);
      }
    }
    for (int d = kWalkLanes / 2; d > 0; d >>= 1) {
      const int64_t other = __shfl_xor_sync(~0u, least, d);
      const uint32_t other_next = __shfl_xor_sync(~0u, next, d);
      if (other < least || (other == least && other_next < next)) least = other, next = other_next;
    }
    walking = walking && next != at.vertex;
    if (walking) at.vertex = next, best = least;
  }
  int64_t least = INT64_MAX, first = INT64_MAX;
  at.point = sheet.position[at.vertex];
  for (int64_t n = begin + lane; n < end; n += kWalkLanes) {
    if (n >= begin + kWalkLanes) load(n);
    const PointQ8 q = closest_point_on_triangle(target, a, b, c);
    const int64_t d = distance_sq_q16(q, target);
    if (d < least) least = d, first = n, at.point = q;
  }
  for (int d = kWalkLanes / 2; d > 0; d >>= 1) {
    const int64_t other = __shfl_xor_sync(~0u, least, d), other_first = __shfl_xor_sync(~0u, first, d);
    const PointQ8 q = {__shfl_xor_sync(~0u, at.point.x, d), __shfl_xor_sync(~0u, at.point.y, d),
                       __shfl_xor_sync(~0u, at.point.z, d)};
    if (other < least || (other == least && other_first < first)) least = other, first = other_first, at.point = q;
  }
  return at;
}

}  // namespace isoshell::cuda_relax
