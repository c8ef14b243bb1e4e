// Does a closed triangle meet a closed cube? Two slow, independent answers: clipping in exact fractions, for small
// coordinates, and separating axes written out in 128 bits, for any.
#pragma once

#include <cstdint>
#include <vector>

#include "voxel/overlap.h"

namespace isoshell::oracle {

using Wide = __int128;

/// A point as fractions x/w, y/w, z/w, in lowest terms, w > 0.
struct Fraction3 {
  Wide at[3], w;
};

inline Wide absolute(Wide x) { return x < 0 ? -x : x; }
inline Wide common_divisor(Wide a, Wide b) {
  for (a = absolute(a), b = absolute(b); b != 0;) {
    const Wide r = a % b;
    a = b;
    b = r;
  }
  return a;
}
inline Fraction3 lowest(Fraction3 p) {
  Wide g = p.w;
  for (Wide c : p.at) g = common_divisor(g, c);
  if (p.w < 0) g = -g;
  return {{p.at[0] / g, p.at[1] / g, p.at[2] / g}, p.w / g};
}

/// The convex polygon's part where sign * (coordinate - bound) >= 0.
inline std::vector<Fraction3> clip(const std::vector<Fraction3>& polygon, int axis, int64_t bound, int sign) {
  const auto side = [&](const Fraction3& p) { return sign * (p.at[axis] - bound * p.w); };
  std::vector<Fraction3> kept;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Fraction3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const Wide sp = side(p), sq = side(q);
    if (sp >= 0) kept.push_back(p);
    if ((sp < 0 && sq > 0) || (sp > 0 && sq < 0)) {
      Fraction3 cut;  // weights sq on p and -sp on q, in homogeneous coordinates
      for (int a = 0; a < 3; ++a) cut.at[a] = sq * p.at[a] - sp * q.at[a];
      cut.w = sq * p.w - sp * q.w;
      kept.push_back(lowest(cut));
    }
  }
  return kept;
}

/// By clipping: is anything of the triangle left inside the cube? Coordinates below about 2^12.
inline bool meets_by_clipping(const TriangleQ8& t, Voxel cell, int shift) {
  std::vector<Fraction3> polygon;
  for (const auto& p : t.at) polygon.push_back({{p[0], p[1], p[2]}, 1});
  const int64_t side = int64_t(1) << shift, lo[3] = {cell.x * side, cell.y * side, cell.z * side};
  for (int axis = 0; axis < 3; ++axis) {
    polygon = clip(polygon, axis, lo[axis], 1);
    polygon = clip(polygon, axis, lo[axis] + (int64_t(1) << shift), -1);
  }
  return !polygon.empty();
}

/// By the thirteen separating axes, both sides of each, one cell at a time.
inline bool meets_by_axes(const TriangleQ8& t, Voxel cell, int shift) {
  Wide p[3][3], edge[3][3];
  const int64_t side = int64_t(1) << shift, lo[3] = {cell.x * side, cell.y * side, cell.z * side};
  for (int i = 0; i < 3; ++i)
    for (int a = 0; a < 3; ++a) {
      p[i][a] = t.at[i][a] - lo[a];
      edge[i][a] = t.at[(i + 1) % 3][a] - t.at[i][a];
    }
  const auto separates = [&](const Wide(&axis)[3]) {
    Wide tri_lo = 0, tri_hi = 0, cube_lo = 0, cube_hi = 0;
    for (int i = 0; i < 3; ++i) {
      const Wide d = axis[0] * p[i][0] + axis[1] * p[i][1] + axis[2] * p[i][2];
      tri_lo = i == 0 || d < tri_lo ? d : tri_lo;
      tri_hi = i == 0 || d > tri_hi ? d : tri_hi;
      (axis[i] > 0 ? cube_hi : cube_lo) += axis[i] * (Wide(1) << shift);
    }
    return tri_lo > cube_hi || tri_hi < cube_lo;
  };
  const auto crossed = [](const Wide(&u)[3], const Wide(&v)[3], Wide(&out)[3]) {
    for (int a = 0; a < 3; ++a) out[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
  };
  Wide axis[3];
  crossed(edge[0], edge[1], axis);
  if (separates(axis)) return false;
  for (int a = 0; a < 3; ++a) {
    Wide unit[3] = {a == 0, a == 1, a == 2};
    if (separates(unit)) return false;
    for (int e = 0; e < 3; ++e) {
      crossed(edge[e], unit, axis);
      if (separates(axis)) return false;
    }
  }
  return true;
}

}  // namespace isoshell::oracle
