#include "cpu/cut_lanes.h"

#include "cpu/vector_versions.h"

namespace isoshell {
namespace {

// What is in 32 bits here fits them while the coordinates of corners and of seeds are below these.
constexpr int32_t kCornerReach = 1 << 12, kSeedReach = 1 << 13;

/// crossing_q15, for values in 32 bits. Signs are masks: the compiler takes no loop with branches.
ISOSHELL_INLINE int32_t crossing(int32_t here, int32_t there) {
  const int32_t before = -here & here >> 31, after = there & -there >> 31;
  const uint32_t neither = (uint32_t(before | after) - 1) >> 31;
  return int32_t(float(kOneQ15) * (float(before) / (float(before) + float(after + int32_t(neither)))));
}

ISOSHELL_INLINE int32_t part_way(int32_t a, int32_t b, int32_t t_q15) {
  return a + (((b - a) * t_q15 + kOneQ15 / 2) >> 15);
}

/// Not 0 when a coordinate is not within the reach, a power of two.
ISOSHELL_INLINE uint32_t beyond(int32_t reach, const CutLanes::Corner& c, int i) {
  return (uint32_t(c.x[i] + reach) | uint32_t(c.y[i] + reach) | uint32_t(c.z[i] + reach)) & ~uint32_t(2 * reach - 1);
}

/// Sum of the corners of a triangle and sum_of_squares of it.
struct Corners {
  int32_t x[CutLanes::kLanes], y[CutLanes::kLanes], z[CutLanes::kLanes], squares[CutLanes::kLanes];
};

ISOSHELL_INLINE int32_t squares_of(int32_t p, int32_t q, int32_t r) {
  const int32_t sum = p + q + r;
  return p * p + q * q + r * r + sum * sum;
}

/// False when some coordinates do not fit; then nothing was done.
ISOSHELL_VECTOR_VERSIONS bool cut_in_lanes(CutLanes& lanes) {
  const int n = lanes.count;
  const CutLanes::Corner &p = lanes.p, &q = lanes.q, &r = lanes.r, &s = lanes.seed, &o = lanes.other_seed;
  uint32_t misfits = 0;
  for (int i = 0; i < n; ++i)
    misfits |= beyond(kCornerReach, p, i) | beyond(kCornerReach, q, i) | beyond(kCornerReach, r, i) |
               beyond(kSeedReach, s, i) | beyond(kSeedReach, o, i) | lanes.area2[i] >> 31;
  if (misfits != 0) return false;

  Corners all, piece;
  uint32_t share[CutLanes::kLanes];  ///< of the area, q15
  for (int i = 0; i < n; ++i) {
    const int32_t dx = o.x[i] - s.x[i], dy = o.y[i] - s.y[i], dz = o.z[i] - s.z[i];
    const int32_t mx = o.x[i] + s.x[i], my = o.y[i] + s.y[i], mz = o.z[i] + s.z[i];
    const int32_t at_p = dx * (2 * p.x[i] - mx) + dy * (2 * p.y[i] - my) + dz * (2 * p.z[i] - mz);
    const int32_t at_q = dx * (2 * q.x[i] - mx) + dy * (2 * q.y[i] - my) + dz * (2 * q.z[i] - mz);
    const int32_t at_r = dx * (2 * r.x[i] - mx) + dy * (2 * r.y[i] - my) + dz * (2 * r.z[i] - mz);
    const int32_t t = crossing(at_p, at_q), u = crossing(at_p, at_r);
    share[i] = uint32_t(t * u) >> 15;
    const int32_t qx = part_way(p.x[i], q.x[i], t), qy = part_way(p.y[i], q.y[i], t), qz = part_way(p.z[i], q.z[i], t);
    const int32_t rx = part_way(p.x[i], r.x[i], u), ry = part_way(p.y[i], r.y[i], u), rz = part_way(p.z[i], r.z[i], u);
    piece.x[i] = p.x[i] + qx + rx;
    piece.y[i] = p.y[i] + qy + ry;
    piece.z[i] = p.z[i] + qz + rz;
    piece.squares[i] = squares_of(p.x[i], qx, rx) + squares_of(p.y[i], qy, ry) + squares_of(p.z[i], qz, rz);
  }
  for (int i = 0; i < n; ++i) {
    all.x[i] = p.x[i] + q.x[i] + r.x[i];
    all.y[i] = p.y[i] + q.y[i] + r.y[i];
    all.z[i] = p.z[i] + q.z[i] + r.z[i];
    all.squares[i] =
        squares_of(p.x[i], q.x[i], r.x[i]) + squares_of(p.y[i], q.y[i], r.y[i]) + squares_of(p.z[i], q.z[i], r.z[i]);
  }
  // What moves is the piece, or all of the triangle but the piece.
  for (int i = 0; i < n; ++i) {
    const uint32_t part = uint32_t(uint64_t(lanes.area2[i]) * share[i] >> 15);
    const int32_t lost = lanes.all_is_at_p[i] ? int32_t(lanes.area2[i]) : 0;
    const int32_t kept = lanes.all_is_at_p[i] ? -int32_t(part) : int32_t(part);
    lanes.mass[i] = int64_t(lost) + kept;
    lanes.first_x[i] = int64_t(lost) * all.x[i] + int64_t(kept) * piece.x[i];
    lanes.first_y[i] = int64_t(lost) * all.y[i] + int64_t(kept) * piece.y[i];
    lanes.first_z[i] = int64_t(lost) * all.z[i] + int64_t(kept) * piece.z[i];
    lanes.second[i] = int64_t(lost) * all.squares[i] + int64_t(kept) * piece.squares[i];
  }
  return true;
}

void cut_one(CutLanes& lanes, int i) {
  const Local other = lanes.other_seed.at(i);
  const SplitTriangle split{
      {lanes.p.at(i), lanes.q.at(i), lanes.r.at(i)}, {lanes.seed.at(i), other, other}, int64_t(lanes.area2[i])};
  split.two_cells(0, [&](int corner, const PieceSum& piece) {
    if ((corner == 0) == (lanes.all_is_at_p[i] != 0)) return;
    lanes.mass[i] = piece.mass, lanes.second[i] = piece.second;
    lanes.first_x[i] = piece.first_x, lanes.first_y[i] = piece.first_y, lanes.first_z[i] = piece.first_z;
  });
}

}  // namespace

void CutLanes::cut() {
  if (cut_in_lanes(*this)) return;
  for (int i = 0; i < count; ++i) cut_one(*this, i);
}

}  // namespace isoshell
