// Exact integer arithmetic on fixed-point positions: differences, squared distances, rounding division, square root.
// Budget: |coordinate| < 2^23 (8192 + margins voxels in q8), so differences < 2^24, squared distances < 2^50.
#pragma once

#include <cstdint>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

__extension__ typedef __int128 Int128;

/// A vector of 64-bit lattice quantities (differences in q8, cross products, sums).
struct Vec64 {
  int64_t x, y, z;
};
ISOSHELL_HD inline Vec64 operator+(Vec64 a, Vec64 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
ISOSHELL_HD inline Vec64 operator-(Vec64 a, Vec64 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
ISOSHELL_HD inline Vec64 operator*(Vec64 a, int64_t s) { return {a.x * s, a.y * s, a.z * s}; }
ISOSHELL_HD inline Vec64 difference(PointQ8 a, PointQ8 b) {
  return {int64_t(a.x) - b.x, int64_t(a.y) - b.y, int64_t(a.z) - b.z};
}
ISOSHELL_HD inline int64_t dot(Vec64 a, Vec64 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
ISOSHELL_HD inline Vec64 cross(Vec64 a, Vec64 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
ISOSHELL_HD inline int64_t distance_sq_q16(PointQ8 a, PointQ8 b) {
  const Vec64 d = difference(a, b);
  return dot(d, d);
}

/// floor(a / b), b > 0.
ISOSHELL_HD inline int64_t floor_div(int64_t a, int64_t b) { return a / b - (a % b < 0); }
/// a / b rounded to nearest, halves up, b > 0.
ISOSHELL_HD inline int64_t round_div(int64_t a, int64_t b) { return floor_div(2 * a + b, 2 * b); }

/// The correctly rounded square root.
ISOSHELL_HD inline double rounded_sqrt(double x) {
#if defined(__CUDA_ARCH__)
  return __dsqrt_rn(x);
#else
  return __builtin_sqrt(x);
#endif
}

/// floor(sqrt(n)), exact, for n < 2^62: the rounded root is off by at most one.
ISOSHELL_HD inline uint64_t isqrt(uint64_t n) {
  uint64_t root = uint64_t(rounded_sqrt(double(n)));
  root -= root * root > n;
  root += (root + 1) * (root + 1) <= n;
  return root;
}

/// Direction of v as a Normal8; (0,0,0) for the zero vector. Any |component| < 2^62.
ISOSHELL_HD inline Normal8 normal8(Vec64 v) {
  const int64_t ax = v.x < 0 ? -v.x : v.x, ay = v.y < 0 ? -v.y : v.y, az = v.z < 0 ? -v.z : v.z;
  int64_t largest = ax > ay ? ax : ay;
  largest = largest > az ? largest : az;
  if (largest == 0) return {0, 0, 0};
  int shift = 0;
  while (largest >> shift >= (int64_t(1) << 20)) ++shift;
  const int up = shift ? 0 : (largest < (1 << 10) ? 10 : 0);
  const Vec64 s = {(v.x >> shift) * (int64_t(1) << up), (v.y >> shift) * (int64_t(1) << up),
                   (v.z >> shift) * (int64_t(1) << up)};
  const int64_t length = int64_t(isqrt(uint64_t(dot(s, s))));
  return {int8_t(round_div(127 * s.x, length)), int8_t(round_div(127 * s.y, length)),
          int8_t(round_div(127 * s.z, length))};
}
ISOSHELL_HD inline int32_t dot(Normal8 a, Normal8 b) {
  return int32_t(a.x) * b.x + int32_t(a.y) * b.y + int32_t(a.z) * b.z;
}

}  // namespace isoshell
