// WalkOntoSheet of stages/sheet/sheet_walk.h by eight lanes a seed: the triangles around a vertex are looked at side by
// side, and those of the last vertex are still in registers when the closest point on them is wanted.
#pragma once

#include "stages/sheet/sheet_walk.h"

namespace isoshell::cuda_relax {

constexpr int kWalkLanes = 8;

/// Where a walk ends: its vertex, and the closest point to the target around that.
struct Landing {
  uint32_t vertex;
  PointQ8 point;
};

/// Every case of it, for the few that the next one leaves.
__device__ __noinline__ inline PointQ8 closest_point_by_cases(PointQ8 p, PointQ8 a, PointQ8 b, PointQ8 c) {
  return closest_point_on_triangle(p, a, b, c);
}

/// closest_point_on_triangle with the same numbers, but lanes that go for a corner, an edge or the inside go one way:
/// each says where it starts and how far it goes along two sides, and all divide and round at once.
__device__ inline PointQ8 closest_point_at_once(PointQ8 p, PointQ8 a, PointQ8 b, PointQ8 c) {
  const Offset32 none{0, 0, 0}, ab = offset_between(a, b), ac = offset_between(a, c), ap = offset_between(a, p),
                                bp = offset_between(b, p), cp = offset_between(c, p);
  const double d1 = double(dot(ab, ap)), d2 = double(dot(ac, ap)), d3 = double(dot(ab, bp)), d4 = double(dot(ac, bp)),
               d5 = double(dot(ab, cp)), d6 = double(dot(ac, cp));
  const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
  PointQ8 from = a;
  Offset32 first = ab, second = ac;
  double v = vb, w = vc, whole = va + vb + vc;
  bool inside = true;
  const auto along = [&](PointQ8 start, Offset32 edge, double part, double length) {
    from = start, first = edge, second = none, v = part, w = 0, whole = length, inside = false;
  };
  // The first case that holds comes last.
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) along(b, offset_between(b, c), d4 - d3, (d4 - d3) + (d5 - d6));
  if (vb <= 0 && d2 >= 0 && d6 <= 0) along(a, ac, d2, d2 - d6);
  if (d6 >= 0 && d5 <= d6) along(c, none, 0, 1);
  if (vc <= 0 && d1 >= 0 && d3 <= 0) along(a, ab, d1, d1 - d3);
  if (d3 >= 0 && d4 <= d3) along(b, none, 0, 1);
  if (d1 <= 0 && d2 <= 0) along(a, none, 0, 1);
  if (inside && whole <= 0x1p-40 * double(dot(ab, ab)) * double(dot(ac, ac))) return closest_point_by_cases(p, a, b, c);
  v /= whole;
  w /= whole;
  return {from.x + round_to_int(v * double(first.x) + w * double(second.x)),
          from.y + round_to_int(v * double(first.y) + w * double(second.y)),
          from.z + round_to_int(v * double(first.z) + w * double(second.z))};
}

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
    const PointQ8 q = closest_point_at_once(target, a, b, c);
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
