#include "cpu/relax/three_cell_simd.h"

namespace isoshell {
namespace {

constexpr int kLanes = ThreeCellSimd::kLanes;
constexpr int kNoCorner = 3;

/// False when some coordinates do not fit 32 bits.
ISOSHELL_VECTOR_VERSIONS bool fit(const ThreeCellSimd& t) {
  uint32_t misfits = 0;
  for (int i = 0; i < kLanes; ++i)
    misfits |= beyond(kCornerReach, t.corner[0].at(i)) | beyond(kCornerReach, t.corner[1].at(i)) |
               beyond(kCornerReach, t.corner[2].at(i)) | beyond(kSeedReach, t.seed[0].at(i)) |
               beyond(kSeedReach, t.seed[1].at(i)) | beyond(kSeedReach, t.seed[2].at(i)) | t.area2[i] >> 31;
  return misfits == 0;
}

/// SplitTriangle::separates for the seed c of corner r.
ISOSHELL_INLINE bool separates(Local p, Local q, Local a, Local b, Local c) {
  const Local m = between_32(p, q, crossing(bisector_value_32(p, a, b), bisector_value_32(q, a, b)));
  return (bisector_value_32(m, a, c) > 0) & (bisector_value_32(m, b, c) > 0);
}

/// The first corner whose cell separates the other two, or kNoCorner.
ISOSHELL_VECTOR_VERSIONS void find_separating(const ThreeCellSimd& t, int32_t* corner) {
  for (int i = 0; i < kLanes; ++i) {
    const Local p = t.corner[0].at(i), q = t.corner[1].at(i), r = t.corner[2].at(i);
    const Local a = t.seed[0].at(i), b = t.seed[1].at(i), c = t.seed[2].at(i);
    const int32_t by_c = separates(p, q, a, b, c) ? 2 : kNoCorner;
    const int32_t by_b = separates(r, p, c, a, b) ? 1 : by_c;
    corner[i] = separates(q, r, b, c, a) ? 0 : by_b;
  }
}

/// SplitTriangle::corner of p against q's seed.
ISOSHELL_INLINE PieceSum corner_of(uint32_t area2, Local p, Local q, Local r, Local a, Local b) {
  const CornerCut cut = cut_corner(p, q, r, a, b);
  return moments(part_of(area2, cut.share_q15), cut.shape);
}

ISOSHELL_INLINE void store(ThreeCellSimd& t, int k, int i, const PieceSum& piece) {
  t.mass[k][i] = piece.mass, t.second[k][i] = piece.second;
  t.first_x[k][i] = piece.first_x, t.first_y[k][i] = piece.first_y, t.first_z[k][i] = piece.first_z;
}

/// Where the last corner's cell separates the others.
ISOSHELL_VECTOR_VERSIONS void split_separated(ThreeCellSimd& t) {
  for (int i = 0; i < kLanes; ++i) {
    const Local p = t.corner[0].at(i), q = t.corner[1].at(i), r = t.corner[2].at(i);
    const Local a = t.seed[0].at(i), b = t.seed[1].at(i), c = t.seed[2].at(i);
    const PieceSum at_p = corner_of(t.area2[i], p, q, r, a, c);
    const PieceSum at_q = corner_of(t.area2[i], q, r, p, b, c);
    store(t, 0, i, at_p);
    store(t, 1, i, at_q);
    store(t, 2, i, moments(int32_t(t.area2[i]), shape_of(p, q, r)) - at_p - at_q);
  }
}

/// Weights of the corners of the triangles in the points where three cells meet, in 1/32768.
struct Meeting {
  int32_t x[3][kLanes];
};

/// SplitTriangle::meeting_point.
ISOSHELL_VECTOR_VERSIONS void find_meeting(const ThreeCellSimd& t, Meeting& meeting) {
  for (int i = 0; i < kLanes; ++i) {
    const Local p = t.corner[0].at(i), q = t.corner[1].at(i), r = t.corner[2].at(i);
    const Local a = t.seed[0].at(i), b = t.seed[1].at(i), c = t.seed[2].at(i);
    const double fp = bisector_value_32(p, a, b), fq = bisector_value_32(q, a, b), fr = bisector_value_32(r, a, b);
    const double gp = bisector_value_32(p, a, c), gq = bisector_value_32(q, a, c), gr = bisector_value_32(r, a, c);
    const double wp = fq * gr - fr * gq, wq = fr * gp - fp * gr, wr = fp * gq - fq * gp;
    const double all = wp + wq + wr, divisor = all != 0 ? all : 1;
    const double third = 1.0 / 3;
    const double xp = all != 0 ? wp / divisor : third, xq = all != 0 ? wq / divisor : third,
                 xr = all != 0 ? wr / divisor : third;
    const double yp = xp > 0 ? xp : 0, yq = xq > 0 ? xq : 0, yr = xr > 0 ? xr : 0;
    const double sum = yp + yq + yr;
    meeting.x[1][i] = int32_t(yq / sum * kOneQ15);
    meeting.x[2][i] = int32_t(yr / sum * kOneQ15);
    meeting.x[0][i] = kOneQ15 - meeting.x[1][i] - meeting.x[2][i];
  }
}

ISOSHELL_INLINE int32_t point_at(int32_t p, int32_t q, int32_t r, int32_t at_q, int32_t at_r) {
  return p + (((q - p) * at_q + (r - p) * at_r + kOneQ15 / 2) >> 15);
}

/// SplitTriangle::around_meeting for the corner p.
ISOSHELL_INLINE PieceSum around_meeting(uint32_t area2, Local p, Local q, Local r, Local a, Local b, Local c,
                                        Local meet, int32_t at_q, int32_t at_r) {
  const int32_t t = crossing(bisector_value_32(p, a, b), bisector_value_32(q, a, b));
  const int32_t u = crossing(bisector_value_32(p, a, c), bisector_value_32(r, a, c));
  return moments(part_of(area2, t * at_r >> 15), shape_of(p, between_32(p, q, t), meet)) +
         moments(part_of(area2, u * at_q >> 15), shape_of(p, meet, between_32(p, r, u)));
}

/// Where no corner's cell separates the others.
ISOSHELL_VECTOR_VERSIONS void split_meeting(ThreeCellSimd& t, const int32_t* separating, const Meeting& meeting,
                                            int k) {
  const int l = (k + 1) % 3, m = (k + 2) % 3;
  for (int i = 0; i < kLanes; ++i) {
    const Local p = t.corner[0].at(i), q = t.corner[1].at(i), r = t.corner[2].at(i);
    const int32_t x1 = meeting.x[1][i], x2 = meeting.x[2][i];
    const Local meet = {point_at(p.x, q.x, r.x, x1, x2), point_at(p.y, q.y, r.y, x1, x2),
                        point_at(p.z, q.z, r.z, x1, x2)};
    const PieceSum piece =
        around_meeting(t.area2[i], t.corner[k].at(i), t.corner[l].at(i), t.corner[m].at(i), t.seed[k].at(i),
                       t.seed[l].at(i), t.seed[m].at(i), meet, meeting.x[l][i], meeting.x[m][i]);
    const bool meets = separating[i] == kNoCorner;
    t.mass[k][i] = meets ? piece.mass : t.mass[k][i];
    t.first_x[k][i] = meets ? piece.first_x : t.first_x[k][i];
    t.first_y[k][i] = meets ? piece.first_y : t.first_y[k][i];
    t.first_z[k][i] = meets ? piece.first_z : t.first_z[k][i];
    t.second[k][i] = meets ? piece.second : t.second[k][i];
  }
}

/// Cells lose the triangles that they had.
ISOSHELL_VECTOR_VERSIONS void take_all(ThreeCellSimd& t, int k) {
  for (int i = 0; i < kLanes; ++i) {
    const PieceSum all = moments(t.has_all[k][i] * int32_t(t.area2[i]),
                                 shape_of(t.corner[0].at(i), t.corner[1].at(i), t.corner[2].at(i)));
    t.mass[k][i] -= all.mass;
    t.first_x[k][i] -= all.first_x;
    t.first_y[k][i] -= all.first_y;
    t.first_z[k][i] -= all.first_z;
    t.second[k][i] -= all.second;
  }
}

/// Turns the corners of triangle i by `by` places.
void turn(ThreeCellSimd& t, int i, int by) {
  const Local corner[3] = {t.corner[0].at(i), t.corner[1].at(i), t.corner[2].at(i)},
              seed[3] = {t.seed[0].at(i), t.seed[1].at(i), t.seed[2].at(i)};
  const uint32_t cell[3] = {t.cell[0][i], t.cell[1][i], t.cell[2][i]};
  const int32_t has_all[3] = {t.has_all[0][i], t.has_all[1][i], t.has_all[2][i]};
  for (int k = 0; k < 3; ++k) {
    const int from = (k + by) % 3;
    t.corner[k].set(i, corner[from]);
    t.seed[k].set(i, seed[from]);
    t.cell[k][i] = cell[from];
    t.has_all[k][i] = has_all[from];
  }
}

void split_simd(ThreeCellSimd& t) {
  int32_t separating[kLanes];
  find_separating(t, separating);
  for (int i = 0; i < t.count; ++i)
    if (separating[i] < 2) turn(t, i, separating[i] + 1);
  Meeting meeting;
  find_meeting(t, meeting);
  split_separated(t);
  for (int k = 0; k < 3; ++k) {
    split_meeting(t, separating, meeting, k);
    take_all(t, k);
  }
}

void split_one(ThreeCellSimd& t, int i) {
  const SplitTriangle split{{t.corner[0].at(i), t.corner[1].at(i), t.corner[2].at(i)},
                            {t.seed[0].at(i), t.seed[1].at(i), t.seed[2].at(i)},
                            int64_t(t.area2[i])};
  split.three_cells(
      [&](int k, const PieceSum& piece) { store(t, k, i, t.has_all[k][i] ? piece - split.total() : piece); });
}

}  // namespace

void ThreeCellSimd::split() {
  if (fit(*this)) return split_simd(*this);
  for (int i = 0; i < count; ++i) split_one(*this, i);
}

}  // namespace isoshell
