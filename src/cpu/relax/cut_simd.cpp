#include "cpu/relax/cut_simd.h"

#include "cpu/relax/cut_arithmetic.h"

namespace isoshell {
namespace {

/// Shapes by lanes.
struct ShapeLanes {
  int32_t x[CutSimd::kLanes], y[CutSimd::kLanes], z[CutSimd::kLanes], squares[CutSimd::kLanes];
  ISOSHELL_INLINE void set(int i, const Shape32& s) {
    x[i] = s.sum.x, y[i] = s.sum.y, z[i] = s.sum.z, squares[i] = int32_t(s.squares);
  }
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

  // Loops of their own for what is in 32 bits and for what is in 64.
  ShapeLanes all, piece;
  int32_t share_q15[CutSimd::kLanes];
  for (int i = 0; i < n; ++i) {
    const CornerCut cut = cut_corner(p.at(i), q.at(i), r.at(i), s.at(i), o.at(i));
    share_q15[i] = cut.share_q15;
    piece.set(i, cut.shape);
  }
  for (int i = 0; i < n; ++i) all.set(i, shape_of(p.at(i), q.at(i), r.at(i)));
  // What moves is the piece, or all of the triangle but the piece.
  for (int i = 0; i < n; ++i) {
    const int32_t part = part_of(lanes.area2[i], share_q15[i]);
    const int32_t lost = lanes.all_is_at_p[i] ? int32_t(lanes.area2[i]) : 0;
    const int32_t kept = lanes.all_is_at_p[i] ? -part : part;
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
