// Distances of voxels to the triangles near them, a leaf at a time.
#pragma once

#include "geometry/triangle_search.h"
#include "isoshell/advanced/voxel_set.h"
#include "voxel/atomic.h"
#include "voxel/leaf.h"

namespace isoshell::level_set_steps {

ISOSHELL_HD inline WorldPoint centre_of(Voxel v) { return {v.x + 0.5, v.y + 0.5, v.z + 0.5}; }

/// Around a triangle, and a little larger than that needs.
struct Sphere {
  WorldPoint middle;
  double radius;
  bool counts_whole;  ///< all points of the triangle count

  ISOSHELL_HD bool is_within(WorldPoint p, double distance) const {
    const WorldPoint away = p - middle;
    const double reach = radius + distance;
    return dot(away, away) <= reach * reach;
  }
};

struct FindSphere {
  View<const WorldPoint> corner;
  int64_t first_of_sheet;
  VoxelSetView near_sheet;
  View<Sphere> sphere;
  ISOSHELL_HD void operator()(int64_t t) const {
    using triangle_search::larger;
    using triangle_search::smaller;
    const WorldPoint a = corner[3 * t], b = corner[3 * t + 1], c = corner[3 * t + 2];
    const WorldPoint low{smaller(smaller(a.x, b.x), c.x), smaller(smaller(a.y, b.y), c.y),
                         smaller(smaller(a.z, b.z), c.z)};
    const WorldPoint high{larger(larger(a.x, b.x), c.x), larger(larger(a.y, b.y), c.y), larger(larger(a.z, b.z), c.z)};
    const WorldPoint at = 0.5 * (low + high);
    const double radius = larger(larger(length(a - at), length(b - at)), length(c - at)) + 1e-6;
    sphere[t] = {at, radius, t >= first_of_sheet || is_near(low, high)};
  }

 private:
  /// Whether all voxels of a small box are near the sheet.
  ISOSHELL_HD bool is_near(WorldPoint low, WorldPoint high) const {
    constexpr int64_t kMostVoxels = 512;  // few triangles with larger boxes are in one leaf
    const Voxel first{int32_t(low.x), int32_t(low.y), int32_t(low.z)},
        last{int32_t(high.x), int32_t(high.y), int32_t(high.z)};
    if (int64_t(last.x - first.x + 1) * (last.y - first.y + 1) * (last.z - first.z + 1) > kMostVoxels) return false;
    for (int32_t x = first.x; x <= last.x; ++x)
      for (int32_t y = first.y; y <= last.y; ++y)
        for (int32_t z = first.z; z <= last.z; ++z)
          if (find_voxel(near_sheet, {x, y, z}) < 0) return false;
    return true;
  }
};

/// The triangles, and which of their points count.
struct Triangles {
  View<const WorldPoint> corner;  ///< see LevelSetSurface
  View<const Sphere> sphere;
  VoxelSetView near_sheet;

  ISOSHELL_HD int64_t count() const { return corner.size / 3; }
  ISOSHELL_HD const WorldPoint* of(int64_t t) const { return &corner[3 * t]; }
  ISOSHELL_HD MeshPoint nearest(WorldPoint p, int64_t t) const {
    const WorldPoint* const c = of(t);
    return nearest_of_triangle(p, c[0], c[1], c[2]);
  }
  ISOSHELL_HD bool counts(int64_t t, WorldPoint at) const {
    return sphere[t].counts_whole || find_voxel(near_sheet, {int32_t(at.x), int32_t(at.y), int32_t(at.z)}) >= 0;
  }
  ISOSHELL_HD bool counts(int64_t t, const MeshPoint& place) const {
    const WorldPoint* const c = of(t);
    return counts(t, c[0] + place.b_part * (c[1] - c[0]) + place.c_part * (c[2] - c[0]));
  }
};

/// Half the diagonal of the box of voxel centres in a cube of so many voxels a side, and a little more for rounding.
ISOSHELL_HD inline double radius_of_cube(int side) { return (side - 1) * 0.8660254037844387 + 1e-6; }

/// Calls visit(leaf) for the leaves with a voxel centre that may be less than the band from a triangle.
struct LeavesOfTriangle {
  Triangles triangles;
  VoxelSetView leaves;
  double band_vox;

  template <class Visit>
  ISOSHELL_HD void for_each(int64_t t, Visit visit) const {
    using triangle_search::larger;
    using triangle_search::smaller;
    const WorldPoint* const c = triangles.of(t);
    const WorldPoint a = c[0], b = c[1], d = c[2];
    const auto first = [&](double p, double q, double r) {
      return int32_t(larger(smaller(smaller(p, q), r) - band_vox - 1, 0)) >> 3;
    };
    const auto last = [&](double p, double q, double r, int32_t blocks) {
      return int32_t(larger(smaller(larger(larger(p, q), r) + band_vox + 1, blocks * 128.0 - 1), 0)) >> 3;
    };
    const int32_t* const dims = leaves.block_dims;
    const Voxel lo{first(a.x, b.x, d.x), first(a.y, b.y, d.y), first(a.z, b.z, d.z)};
    const Voxel hi{last(a.x, b.x, d.x, dims[0]), last(a.y, b.y, d.y, dims[1]), last(a.z, b.z, d.z, dims[2])};
    const double reach = band_vox + radius_of_cube(8);
    const auto is_near = [&](Voxel cube, int side, double within) {
      const double half = side / 2.0;
      const WorldPoint middle{side * cube.x + half, side * cube.y + half, side * cube.z + half};
      return triangles.nearest(middle, t).distance_sq <= within * within;
    };
    // By blocks of leaves: the box of a large triangle is mostly empty.
    for_each_cube({lo.x >> 4, lo.y >> 4, lo.z >> 4}, {hi.x >> 4, hi.y >> 4, hi.z >> 4}, [&](Voxel block) {
      const int64_t number = (int64_t(block.x) * dims[1] + block.y) * dims[2] + block.z;
      if (leaves.block_table[number] == kNone || !is_near(block, 128, band_vox + radius_of_cube(128))) return;
      const Voxel first_leaf{block.x * 16, block.y * 16, block.z * 16};
      for_each_cube({larger_of(lo.x, first_leaf.x), larger_of(lo.y, first_leaf.y), larger_of(lo.z, first_leaf.z)},
                    {smaller_of(hi.x, first_leaf.x + 15), smaller_of(hi.y, first_leaf.y + 15),
                     smaller_of(hi.z, first_leaf.z + 15)},
                    [&](Voxel at) {
                      const uint32_t leaf = find_leaf(leaves, at);
                      if (leaf != kNone && is_near(at, 8, reach)) visit(leaf);
                    });
    });
  }

 private:
  ISOSHELL_HD static int32_t smaller_of(int32_t a, int32_t b) { return a < b ? a : b; }
  ISOSHELL_HD static int32_t larger_of(int32_t a, int32_t b) { return a > b ? a : b; }
  template <class Visit>
  ISOSHELL_HD static void for_each_cube(Voxel from, Voxel to, Visit visit) {
    for (int32_t x = from.x; x <= to.x; ++x)
      for (int32_t y = from.y; y <= to.y; ++y)
        for (int32_t z = from.z; z <= to.z; ++z) visit(Voxel{x, y, z});
  }
};

struct CountListed {
  LeavesOfTriangle near;
  View<uint32_t> count;
  ISOSHELL_HD void operator()(int64_t t) const {
    near.for_each(t, [&](uint32_t leaf) { atomic_add(count[leaf], 1u); });
  }
};

/// Fills lists from their ends. Their order does not matter: what is made of them are minima.
struct ListTriangles {
  LeavesOfTriangle near;
  View<const int64_t> first;
  View<uint32_t> left, listed;
  ISOSHELL_HD void operator()(int64_t t) const {
    near.for_each(t, [&](uint32_t leaf) { listed[first[leaf] + atomic_take_one_below(left[leaf])] = uint32_t(t); });
  }
};

/// Distances of a leaf's candidates, and which of them are in the band. Cubes of eight, four and two voxels keep what
/// may be nearest to one of their centres, at the front of the leaf's list, which nothing else reads meanwhile.
struct MeasureLeaf {
  Triangles triangles;
  VoxelSetView candidates;
  double band_vox;
  View<const int64_t> first;
  View<uint32_t> listed;
  View<float> distance;
  View<LeafMask> active;

  ISOSHELL_HD void operator()(int64_t leaf) const {
    const LeafMask& mask = candidates.mask[leaf];
    const Voxel origin = voxel_at(leaf_of_key(candidates.leaf_key[leaf]), 0);
    LeafMask in_band{};
    const View<uint32_t> list = listed.part(first[leaf], first[leaf + 1] - first[leaf]);
    for (int four = 0; four < 8; ++four) {
      const Voxel at{(four >> 2) * 4, (four >> 1 & 1) * 4, (four & 1) * 4};
      const int64_t kept = keep_near(list, list.size, origin, at, 4);
      for (int two = 0; two < 8; ++two)
        measure_cube(leaf, mask, list, kept, origin,
                     {at.x + (two >> 2) * 2, at.y + (two >> 1 & 1) * 2, at.z + (two & 1) * 2}, in_band);
    }
    active[leaf] = in_band;
  }

 private:
  /// Brings the triangles that may be nearest to a voxel of the cube to the front, one that is near first, and returns
  /// their number. Only a triangle that counts as a whole tells how near the nearest one is at all of them.
  ISOSHELL_HD int64_t keep_near(View<uint32_t> list, int64_t count, Voxel origin, Voxel at, int side) const {
    const double half = side / 2.0, radius = radius_of_cube(side);
    const WorldPoint middle{origin.x + at.x + half, origin.y + at.y + half, origin.z + at.z + half};
    double least = band_vox + radius, farthest = least;  // of those that count, from the middle; and of what is kept
    int64_t kept = 0;
    for (int64_t i = 0; i < count; ++i) {
      if (!triangles.sphere[list[i]].is_within(middle, farthest)) continue;
      swap(list[kept], list[i]);
      const MeshPoint place = nearest_within(middle, list[kept], least);
      if (place.distance_sq < least * least && triangles.sphere[list[kept]].counts_whole) {
        least = std::sqrt(place.distance_sq);
        farthest = triangle_search::smaller(farthest, least + 2 * radius);
        swap(list[0], list[kept]);
      }
      ++kept;
    }
    return kept;
  }

  /// Infinitely far where the triangle is farther than that for sure.
  ISOSHELL_HD MeshPoint nearest_within(WorldPoint p, uint32_t t, double farthest) const {
    return triangles.sphere[t].is_within(p, farthest) ? triangles.nearest(p, t) : MeshPoint{};
  }

  ISOSHELL_HD void measure_cube(int64_t leaf, const LeafMask& mask, View<uint32_t> list, int64_t count, Voxel origin,
                                Voxel at, LeafMask& in_band) const {
    int64_t kept = -1;
    for (int i = 0; i < 8; ++i) {
      const Voxel v{at.x + (i >> 2), at.y + (i >> 1 & 1), at.z + (i & 1)};
      const int offset = offset_in_leaf(v);
      if (!is_on(mask, offset)) continue;
      if (kept < 0) kept = keep_near(list, count, origin, at, 2);
      const double found = measure({origin.x + v.x, origin.y + v.y, origin.z + v.z}, list, kept);
      distance[candidates.first[leaf] + rank_in_leaf(mask, offset)] = float(found);
      if (found < band_vox) in_band.word[offset >> 6] |= uint64_t(1) << (offset & 63);
    }
  }

  ISOSHELL_HD double measure(Voxel v, View<uint32_t> list, int64_t count) const {
    const WorldPoint centre = centre_of(v);
    double least_sq = band_vox * band_vox, least = band_vox;
    for (int64_t i = 0; i < count; ++i) {
      const MeshPoint place = nearest_within(centre, list[i], least);
      if (place.distance_sq >= least_sq || !triangles.counts(list[i], place)) continue;
      least_sq = place.distance_sq;
      least = std::sqrt(least_sq);
    }
    return least;
  }

  ISOSHELL_HD static void swap(uint32_t& a, uint32_t& b) {
    const uint32_t was = a;
    a = b;
    b = was;
  }
};

}  // namespace isoshell::level_set_steps
