// Nearest seed of every active voxel (paper section 3.2), by leaves: one list of the seeds near a leaf, shorter ones
// for its smaller cubes, and one search a voxel where seeds are too many for a list. All give the same labels.
#pragma once

#include "stages/sparse/point_grid_body.h"
#include "voxel/leaf_candidates.h"

namespace isoshell {

/// The active voxels of a cube, by their places from the centre of the leaf's voxel 0, and what labelling finds.
template <class T>
struct LabelledVoxels {
  int count = 0;
  int32_t offset[512];
  T x[512], y[512], z[512];
  T distance_sq_q16[512];
  int32_t nearest[512];  ///< place in the list

  ISOSHELL_HD explicit LabelledVoxels(const LeafCube& cube) {
    for (int i = 0; i < cube.edge; ++i)
      for (uint64_t bits = cube.row[i]; bits; bits &= bits - 1) offset[count++] = (cube.x + i) << 6 | lowest_bit(bits);
    int whole = count;
    while (whole % 4 != 0) offset[whole++] = 0;
    for (int i = 0; i < whole; ++i) {
      x[i] = (offset[i] >> 6) * kOneVoxelQ8;
      y[i] = (offset[i] >> 3 & 7) * kOneVoxelQ8;
      z[i] = (offset[i] & 7) * kOneVoxelQ8;
    }
  }

  ISOSHELL_HD T most_distance_sq_q16() const {
    T most = 0;
    for (int i = 0; i < count; ++i) most = distance_sq_q16[i] > most ? distance_sq_q16[i] : most;
    return most;
  }

  /// Equal distances go to the first.
  ISOSHELL_HD void find_nearest(const PointList& points) {
    const int whole = (count + 3) / 4 * 4;
    offer_first(points.place(0), whole);
    for (int c = 1; c < points.count; ++c) offer(points.place(c), c, whole);
  }

 private:
  ISOSHELL_HD T to(Vec64 p, int i) const {
    const T dx = x[i] - T(p.x), dy = y[i] - T(p.y), dz = z[i] - T(p.z);
    return dx * dx + dy * dy + dz * dz;
  }
  ISOSHELL_HD void offer_first(Vec64 p, int whole) {
    for (int i = 0; i < whole; ++i) {
      distance_sq_q16[i] = to(p, i);
      nearest[i] = 0;
    }
  }
  ISOSHELL_HD void offer(Vec64 p, int c, int whole) {
    for (int i = 0; i < whole; ++i) {
      const T here = to(p, i);
      nearest[i] = here < distance_sq_q16[i] ? c : nearest[i];
      distance_sq_q16[i] = here < distance_sq_q16[i] ? here : distance_sq_q16[i];
    }
  }
};

/// One leaf: label its active voxels and hand the labels to the sink: voxel(leaf, offset, seed) for one that was
/// searched alone; open(leaf, list) for a cube, then voxel(place in the list, offset, squared distance) for each of its
/// voxels, and finish() when they are right.
template <class Sink>
struct LabelLeaf {
  VoxelSetView voxels;
  PointGridView grid;
  Sink sink;
  View<int32_t> reach_q8;  ///< per leaf: how far to look first. Labels do not depend on it; they set it for next time
  int32_t slack_q8;        ///< how much farther than labels were

  ISOSHELL_HD void operator()(int64_t leaf) const {
    const int64_t most = label(leaf, cube_of_leaf(voxels.mask[leaf], 8, 0, 0, 0), reach_q8[leaf]);
    reach_q8[leaf] = reach_of(most) + slack_q8;
  }

 private:
  ISOSHELL_HD static int32_t reach_of(int64_t distance_sq_q16) { return int32_t(isqrt(uint64_t(distance_sq_q16))) + 1; }

  /// Lists the seeds within reach of the cube, and looks again where a label is farther than that. Returns the largest
  /// squared distance of a voxel from its seed.
  ISOSHELL_HD int64_t label(int64_t leaf, const LeafCube& cube, int32_t reach) const {
    if (cube.empty()) return 0;
    const PointQ8 origin = voxel_centre(voxel_at(leaf_of_key(voxels.leaf_key[leaf]), 0));
    const BoxQ8 box = box_of_centres(cube);
    for (PointList near;;) {
      gather_near(grid, origin, box, reach, near);
      if (near.count > kMaxNear) return label_parts(leaf, cube, reach);
      if (near.count == 0) {
        reach *= 2;
        continue;
      }
      auto into = sink.open(leaf, near);
      const int64_t most =
          near.is_narrow() ? divide<int32_t>(leaf, cube, near, into) : divide<int64_t>(leaf, cube, near, into);
      if (most <= int64_t(reach) * reach) {
        into.finish();
        return most;
      }
      reach = reach_of(most);
    }
  }

  /// Of a cube with more seeds around it than a list holds: its octants; a voxel looks for its seed by itself.
  ISOSHELL_HD int64_t label_parts(int64_t leaf, const LeafCube& cube, int32_t reach) const {
    if (cube.edge == 1) {
      const int offset = cube.x << 6 | cube.y << 3 | cube.z;
      const NearestPoint nearest =
          nearest_point(grid, voxel_centre(voxel_at(leaf_of_key(voxels.leaf_key[leaf]), offset)));
      sink.voxel(leaf, offset, nearest.id);
      return nearest.distance_sq_q16;
    }
    int64_t most = 0;
    for (int i = 0; i < 8; ++i) {
      const int64_t here = label(leaf, octant_of(voxels.mask[leaf], cube, i), reach);
      most = here > most ? here : most;
    }
    return most;
  }

  /// Labels from those of the seeds that can win in the cube; where they are many, by octants.
  template <class T, class Into>
  ISOSHELL_HD int64_t divide(int64_t leaf, const LeafCube& cube, const PointList& seeds, Into& into) const {
    constexpr int kMany = 4096;  // of voxels and seeds in pairs: then shorter lists save more than they cost
    PointList winnable;
    keep_winnable<T>(seeds, box_of_centres(cube), winnable);
    if (winnable.count * cube.edge * cube.edge * cube.edge <= kMany) return label_voxels<T>(cube, winnable, into);
    int64_t most = 0;
    for (int i = 0; i < 8; ++i) {
      const LeafCube octant = octant_of(voxels.mask[leaf], cube, i);
      if (octant.empty()) continue;
      const int64_t here = divide<T>(leaf, octant, winnable, into);
      most = here > most ? here : most;
    }
    return most;
  }

  template <class T, class Into>
  ISOSHELL_HD static int64_t label_voxels(const LeafCube& cube, const PointList& seeds, Into& into) {
    PointList sorted;
    sort_by_id(seeds, sorted);
    LabelledVoxels<T> voxels(cube);
    voxels.find_nearest(sorted);
    for (int i = 0; i < voxels.count; ++i)
      into.voxel(sorted.number[voxels.nearest[i]], voxels.offset[i], voxels.distance_sq_q16[i]);
    return voxels.most_distance_sq_q16();
  }
};

}  // namespace isoshell
