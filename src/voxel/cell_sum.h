// Integer moments of surface pieces, and the split of one triangle between the cells of its corners by their bisectors.
//
// A piece of triangle with corners u0, u1, u2 (q8, relative to a local origin) and doubled area A contributes
//   mass += A,  first += A (u0 + u1 + u2),  second += A (|u0|^2 + |u1|^2 + |u2|^2 + |u0 + u1 + u2|^2),
// so that, up to the common factor 1/2, the integral of 1 is mass, of x is first / 3 and of |x|^2 is second / 12.
// Budget: |u| < 2^13 (VertexBlocks::kReachQ8), A < 2^32: second < 2^63 for up to 2^2 such extremes; a block of
// ordinary triangles (A about 2^16) stays below 2^52.
#pragma once

#include <cstdint>

#include "voxel/exact_int.h"

namespace isoshell {

struct PieceSum {
  int64_t mass, first_x, first_y, first_z, second;
};
ISOSHELL_HD inline PieceSum operator+(const PieceSum& a, const PieceSum& b) {
  return {a.mass + b.mass, a.first_x + b.first_x, a.first_y + b.first_y, a.first_z + b.first_z, a.second + b.second};
}
ISOSHELL_HD inline PieceSum operator-(const PieceSum& a, const PieceSum& b) {
  return {a.mass - b.mass, a.first_x - b.first_x, a.first_y - b.first_y, a.first_z - b.first_z, a.second - b.second};
}

/// Corner relative to the local origin, q8.
struct Local {
  int32_t x, y, z;
};
ISOSHELL_HD inline Local local(PointQ8 p, PointQ8 origin) { return {p.x - origin.x, p.y - origin.y, p.z - origin.z}; }

ISOSHELL_HD inline int64_t square(Local u) { return int64_t(u.x) * u.x + int64_t(u.y) * u.y + int64_t(u.z) * u.z; }

ISOSHELL_HD inline Local corner_sum(Local a, Local b, Local c) {
  return {a.x + b.x + c.x, a.y + b.y + c.y, a.z + b.z + c.z};
}
ISOSHELL_HD inline int64_t sum_of_squares(Local a, Local b, Local c) {
  return square(a) + square(b) + square(c) + square(corner_sum(a, b, c));
}
ISOSHELL_HD inline PieceSum piece_sum(int64_t area2, Local a, Local b, Local c) {
  const Local sum = corner_sum(a, b, c);
  return {area2, area2 * sum.x, area2 * sum.y, area2 * sum.z, area2 * sum_of_squares(a, b, c)};
}

/// |v - a|^2 - |v - b|^2: negative where a is nearer. Exact, and linear in v.
ISOSHELL_HD inline int64_t bisector_value(Local v, Local a, Local b) {
  return int64_t(b.x - a.x) * (2 * v.x - a.x - b.x) + int64_t(b.y - a.y) * (2 * v.y - a.y - b.y) +
         int64_t(b.z - a.z) * (2 * v.z - a.z - b.z);
}

constexpr int32_t kOneQ15 = 1 << 15;

/// Where a linear function with value `here` at one end and `there` at the other is zero, in 1/32768 of the way. The
/// label penalty can put both values on one side; then the nearer end. The quotient follows in single precision: one
/// correctly rounded division, then an integer.
ISOSHELL_HD inline int32_t crossing_q15(int64_t here, int64_t there) {
  if (here >= 0) return 0;
  if (there <= 0) return kOneQ15;
  return int32_t(float(kOneQ15) * (float(-here) / (float(-here) + float(there))));
}

/// The point t of the way from a to b.
ISOSHELL_HD inline Local between(Local a, Local b, int32_t t_q15) {
  return {a.x + int32_t((int64_t(b.x - a.x) * t_q15 + kOneQ15 / 2) >> 15),
          a.y + int32_t((int64_t(b.y - a.y) * t_q15 + kOneQ15 / 2) >> 15),
          a.z + int32_t((int64_t(b.z - a.z) * t_q15 + kOneQ15 / 2) >> 15)};
}

/// The corner at p of the triangle (p, q, r), cut off at t_q and t_r along its two sides.
ISOSHELL_HD inline PieceSum corner_piece(int64_t area2, Local p, Local q, Local r, int32_t t_q, int32_t t_r) {
  const int64_t part = area2 * ((int64_t(t_q) * t_r) >> 15) >> 15;
  return piece_sum(part, p, between(p, q, t_q), between(p, r, t_r));
}

/// Splits the triangle p[0..2] between the seeds s[0..2] of its corners. The caller, who knows which seeds are equal,
/// takes two_cells or three_cells. Adds the piece of corner i through add(i, piece).
///
/// Two cells: the bisector cuts one corner off. Three cells: when the third seed wins where the bisector of two corners
/// meets their edge, it separates them and each of the two keeps a corner; else the three bisectors meet inside in X
/// and each cell is the quadrilateral (corner, crossing, X, crossing).
struct SplitTriangle {
  Local p[3];
  Local s[3];
  int64_t area2;

  /// Corner `i` alone against the other two, which share a seed.
  template <class Add>
  ISOSHELL_HD void two_cells(int i, Add add) const {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const PieceSum cut = corner(i, j);
    add(i, cut);
    add(k, piece_sum(area2, p[0], p[1], p[2]) - cut);
  }

  template <class Add>
  ISOSHELL_HD void three_cells(Add add) const {
    for (int k = 0; k < 3; ++k) {
      if (!separates(k)) continue;
      const int i = (k + 1) % 3, j = (k + 2) % 3;
      const PieceSum a = corner(i, k), b = corner(j, k);
      add(i, a);
      add(j, b);
      add(k, total() - a - b);
      return;
    }
    const Barycentric x = meeting_point();
    const Local meet = point_at(x);
    for (int i = 0; i < 3; ++i) add(i, around_meeting(i, meet, x));
  }

  // The parts of three_cells.

  ISOSHELL_HD PieceSum total() const { return piece_sum(area2, p[0], p[1], p[2]); }

  /// True when seed k wins where the bisector of the other two meets their edge.
  ISOSHELL_HD bool separates(int k) const {
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    const Local m =
        between(p[i], p[j], crossing_q15(bisector_value(p[i], s[i], s[j]), bisector_value(p[j], s[i], s[j])));
    return bisector_value(m, s[i], s[k]) > 0 && bisector_value(m, s[j], s[k]) > 0;
  }

  /// Part of corner i on its own side of the bisector with the seed of corner j.
  ISOSHELL_HD PieceSum corner(int i, int j) const {
    const int q = (i + 1) % 3, r = (i + 2) % 3;
    const int64_t at = bisector_value(p[i], s[i], s[j]);
    return corner_piece(area2, p[i], p[q], p[r], crossing_q15(at, bisector_value(p[q], s[i], s[j])),
                        crossing_q15(at, bisector_value(p[r], s[i], s[j])));
  }

  /// Weights of the corners, in 1/32768.
  struct Barycentric {
    int32_t x[3];
  };
  ISOSHELL_HD Local point_at(const Barycentric& b) const {
    const int32_t* x = b.x;
    return {p[0].x + int32_t((int64_t(p[1].x - p[0].x) * x[1] + int64_t(p[2].x - p[0].x) * x[2] + kOneQ15 / 2) >> 15),
            p[0].y + int32_t((int64_t(p[1].y - p[0].y) * x[1] + int64_t(p[2].y - p[0].y) * x[2] + kOneQ15 / 2) >> 15),
            p[0].z + int32_t((int64_t(p[1].z - p[0].z) * x[1] + int64_t(p[2].z - p[0].z) * x[2] + kOneQ15 / 2) >> 15)};
  }

  /// The piece of corner i when the three cells meet inside, at `meet` with weights `b`.
  ISOSHELL_HD PieceSum around_meeting(int i, Local meet, const Barycentric& b) const {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    const int32_t t = crossing_q15(bisector_value(p[i], s[i], s[j]), bisector_value(p[j], s[i], s[j]));
    const int32_t u = crossing_q15(bisector_value(p[i], s[i], s[k]), bisector_value(p[k], s[i], s[k]));
    const int64_t part_j = area2 * ((int64_t(t) * b.x[k]) >> 15) >> 15;
    const int64_t part_k = area2 * ((int64_t(u) * b.x[j]) >> 15) >> 15;
    return piece_sum(part_j, p[i], between(p[i], p[j], t), meet) +
           piece_sum(part_k, p[i], meet, between(p[i], p[k], u));
  }

  /// The point at equal distance from the three seeds, clamped to the triangle.
  ISOSHELL_HD Barycentric meeting_point() const {
    double f[3], g[3], w[3];
    for (int i = 0; i < 3; ++i) {
      f[i] = double(bisector_value(p[i], s[0], s[1]));
      g[i] = double(bisector_value(p[i], s[0], s[2]));
    }
    double total = 0;
    for (int i = 0; i < 3; ++i) w[i] = f[(i + 1) % 3] * g[(i + 2) % 3] - f[(i + 2) % 3] * g[(i + 1) % 3];
    total = w[0] + w[1] + w[2];
    for (int i = 0; i < 3; ++i) {
      w[i] = total != 0 ? w[i] / total : 1.0 / 3;
      if (!(w[i] > 0)) w[i] = 0;
    }
    total = w[0] + w[1] + w[2];
    const int32_t x1 = int32_t(w[1] / total * kOneQ15), x2 = int32_t(w[2] / total * kOneQ15);
    return {{kOneQ15 - x1 - x2, x1, x2}};
  }
};

}  // namespace isoshell
