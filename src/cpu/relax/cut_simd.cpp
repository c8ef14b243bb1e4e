#include "cpu/relax/cut_simd.h"

#include "cpu/relax/cut_arithmetic.h"

namespace isoshell {
namespace {

/// Sum of the corners of a triangle and sum_of_squares of it.
struct Corners {
  int32_t x[CutSimd::kLanes], y[CutSimd::kLanes], z[CutSimd::kLanes], squares[CutSimd::kLanes];
};

/// False when some coordinates do not fit; then nothing was done.
ISOSHELL_VECTOR_VERSIONS bool cut_simd(CutSimd& lanes) {
  const int n = lanes.count;
  const CutSimd::Corner &p = lanes.p, &q = lanes.q, &r = lanes.r, &s = lanes.seed, &o = lanes.other_seed;
  uint32_t misfits = 0;
  for (int i = 0; i < n; ++i)
    misfits |= beyond(kCornerReach, p.at(i)) | beyond(kCornerReach, q.at(i)) | beyond(kCornerReach, r.at(i)) |
               beyond(kSeedReach, s.at(i)) | beyond(kSeedReach, o.at(i)) | lanes.area2[i] >> 31;
  if (misfits != 0) return false;

  Corners all, piece;
  uint32_t share[CutSimd::kLanes];  ///< of the area, q15
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

void cut_one(CutSimd& lanes, int i) {
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

void CutSimd::cut() {
  if (cut_simd(*this)) return;
  for (int i = 0; i < count; ++i) cut_one(*this, i);
}

}  // namespace isoshell
