// Which points can be the nearest one of some voxel in a block of a leaf: gathered once a block, so that a voxel
// compares a handful of them. Exact: a point stays out only when others are strictly nearer, or as near with a smaller
// id, at every voxel of the block.
#pragma once

#include "voxel/leaf.h"
#include "voxel/point_grid.h"

namespace isoshell {

constexpr int kMaxCandidates = 32;

/// A cube of voxels in a leaf and its active ones.
struct LeafCube {
  int edge, x, y, z;  ///< in voxels; the smallest voxel by its offsets in the leaf
  uint64_t row[8];    ///< active voxels of slice x + i, i < edge; bits are those of the leaf

  ISOSHELL_HD bool empty() const {
    uint64_t any = 0;
    for (int i = 0; i < edge; ++i) any |= row[i];
    return any == 0;
  }
};

ISOSHELL_HD inline LeafCube cube_of_leaf(const LeafMask& mask, int edge, int x, int y, int z) {
  LeafCube block{edge, x, y, z, {}};
  const uint64_t line = ((uint64_t(1) << edge) - 1) << z;
  uint64_t square = 0;
  for (int i = y; i < y + edge; ++i) square |= line << (8 * i);
  for (int i = 0; i < edge; ++i) block.row[i] = mask.word[x + i] & square;
  return block;
}

/// One of the eight halves along each axis.
ISOSHELL_HD inline LeafCube octant_of(const LeafMask& mask, const LeafCube& cube, int number) {
  const int half = cube.edge / 2;
  return cube_of_leaf(mask, half, cube.x + (number >> 2) * half, cube.y + (number >> 1 & 1) * half,
                      cube.z + (number & 1) * half);
}

/// Tight box of the centres of the block's active voxels, `origin` being the centre of the leaf's voxel 0. Not for an
/// empty block.
ISOSHELL_HD inline BoxQ8 box_of_centres(const LeafCube& block, PointQ8 origin) {
  int x_lo = 8, x_hi = 0, y_lo = 8, y_hi = 0;
  uint64_t all = 0;
  for (int i = 0; i < block.edge; ++i)
    if (block.row[i]) {
      x_lo = x_lo < 8 ? x_lo : block.x + i;
      x_hi = block.x + i;
      all |= block.row[i];
    }
  uint32_t line = 0;
  for (int y = 0; y < 8; ++y)
    if (const uint32_t here = uint32_t(all >> (8 * y)) & 255) {
      y_lo = y_lo < 8 ? y_lo : y;
      y_hi = y;
      line |= here;
    }
  const int z_lo = lowest_bit(line);
  int z_hi = z_lo;
  for (int z = z_lo; z < 8; ++z) z_hi = line >> z & 1 ? z : z_hi;
  return {{origin.x + x_lo * kOneVoxelQ8, origin.y + y_lo * kOneVoxelQ8, origin.z + z_lo * kOneVoxelQ8},
          {origin.x + x_hi * kOneVoxelQ8, origin.y + y_hi * kOneVoxelQ8, origin.z + z_hi * kOneVoxelQ8}};
}

/// Points whose least distance to the box is at most the smallest greatest distance of any point; at most
/// kMaxCandidates.
struct Candidates {
  BoxQ8 box;
  int64_t bound = int64_t(1) << 62;  ///< smallest greatest squared distance so far
  int count = 0;
  bool overflow = false;
  GridPoint point[kMaxCandidates];
  int64_t least[kMaxCandidates];  ///< least squared distance to the box

  ISOSHELL_HD explicit Candidates(const BoxQ8& b) : box(b) {}
  ISOSHELL_HD int64_t bound_q16() const { return overflow ? -1 : bound; }

  ISOSHELL_HD static void add_axis(int32_t lo, int32_t hi, int32_t p, int64_t& near_sq, int64_t& far_sq) {
    const int64_t below = int64_t(lo) - p, above = int64_t(p) - hi;
    const int64_t out = below > above ? below : above;
    if (out > 0) near_sq += out * out;
    const int64_t far_lo = below < 0 ? -below : below, far_hi = above < 0 ? -above : above;
    const int64_t far = far_lo > far_hi ? far_lo : far_hi;
    far_sq += far * far;
  }

  ISOSHELL_HD void operator()(const GridPoint& p) {
    int64_t near_sq = 0, far_sq = 0;
    add_axis(box.lo.x, box.hi.x, p.position.x, near_sq, far_sq);
    add_axis(box.lo.y, box.hi.y, p.position.y, near_sq, far_sq);
    add_axis(box.lo.z, box.hi.z, p.position.z, near_sq, far_sq);
    if (near_sq > bound || overflow) return;
    bound = far_sq < bound ? far_sq : bound;
    if (count == kMaxCandidates) drop_far();
    if (count == kMaxCandidates) {
      overflow = true;
      return;
    }
    least[count] = near_sq;
    point[count++] = p;
  }

  ISOSHELL_HD void drop_far() {
    int kept = 0;
    for (int i = 0; i < count; ++i)
      if (least[i] <= bound) {
        least[kept] = least[i];
        point[kept++] = point[i];
      }
    count = kept;
  }
};

/// True when a beats b at every point of the box: the difference of their squared distances is linear, so its largest
/// value is that of one corner.
ISOSHELL_HD inline bool beats_in_box(const BoxQ8& box, const GridPoint& a, const GridPoint& b) {
  const auto axis = [](int32_t lo, int32_t hi, int32_t pa, int32_t pb) {
    const int64_t v = pb > pa ? hi : lo;
    return (v - pa) * (v - pa) - (v - pb) * (v - pb);
  };
  const int64_t most = axis(box.lo.x, box.hi.x, a.position.x, b.position.x) +
                       axis(box.lo.y, box.hi.y, a.position.y, b.position.y) +
                       axis(box.lo.z, box.hi.z, a.position.z, b.position.z);
  return most < 0 || (most == 0 && a.id < b.id);
}

/// Drops what the point that is nearest to the middle of the box beats everywhere: most of what goes, for one
/// comparison a point.
ISOSHELL_HD inline void drop_beaten_by_best(Candidates& out) {
  const BoxQ8& box = out.box;
  int best = 0;
  int64_t nearest = int64_t(1) << 62;
  for (int i = 0; i < out.count; ++i) {
    const PointQ8 p = out.point[i].position;  // twice as far as the middle is
    const int64_t x = 2 * int64_t(p.x) - box.lo.x - box.hi.x, y = 2 * int64_t(p.y) - box.lo.y - box.hi.y,
                  z = 2 * int64_t(p.z) - box.lo.z - box.hi.z;
    const int64_t d = x * x + y * y + z * z;
    if (d < nearest) nearest = d, best = i;
  }
  const GridPoint first = out.point[best];
  int kept = 0;
  for (int i = 0; i < out.count; ++i)
    if (i == best || !beats_in_box(box, first, out.point[i])) out.point[kept++] = out.point[i];
  out.count = kept;
}

/// Gathers, drops what others beat everywhere, sorts by id. The outcome does not depend on the order within grid cells.
ISOSHELL_HD inline void gather_candidates(const PointGridView& grid, Candidates& out) {
  visit_around(grid, out.box, out);
  if (out.overflow) return;
  out.drop_far();
  drop_beaten_by_best(out);
  // Beating is transitive, so comparing with points that are out themselves changes nothing.
  bool beaten[kMaxCandidates];
  for (int b = 0; b < out.count; ++b) {
    beaten[b] = false;
    for (int a = 0; a < out.count && !beaten[b]; ++a)
      beaten[b] = a != b && beats_in_box(out.box, out.point[a], out.point[b]);
  }
  int kept = 0;
  for (int i = 0; i < out.count; ++i) {
    if (beaten[i]) continue;
    const GridPoint p = out.point[i];
    int at = kept++;
    for (; at > 0 && out.point[at - 1].id > p.id; --at) out.point[at] = out.point[at - 1];
    out.point[at] = p;
  }
  out.count = kept;
}

}  // namespace isoshell
