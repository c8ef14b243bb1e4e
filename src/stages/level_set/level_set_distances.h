// Distances of voxels to the triangles near them, a leaf at a time.
#pragma once

#include "stages/level_set/level_set_triangles.h"

namespace isoshell::level_set_steps {

/// Distances of a leaf's candidates, and which of them are in the band. Cubes of four and two voxels keep what may be
/// nearest to one of their centres, at the front of the leaf's list, which nothing else reads meanwhile.
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
    const double half = side / 2.0, radius = (side - 1) * 0.8660254037844387 + Disc::kSlack;
    const WorldPoint middle{origin.x + at.x + half, origin.y + at.y + half, origin.z + at.z + half};
    double least = band_vox + radius, farthest = least;  // of those that count, from the middle; and of what is kept
    int64_t kept = 0;
    for (int64_t i = 0; i < count; ++i) {
      if (!triangles.disc[list[i]].is_within(middle, farthest)) continue;
      swap(list[kept], list[i]);
      const MeshPoint place = nearest_within(middle, list[kept], least);
      if (place.distance_sq < least * least && triangles.disc[list[kept]].counts_whole) {
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
    return triangles.disc[t].is_within(p, farthest) ? triangles.nearest(p, t) : MeshPoint{};
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

  /// The nearest triangle of a voxel becomes the first one: it is near the next voxel, too.
  ISOSHELL_HD double measure(Voxel v, View<uint32_t> list, int64_t count) const {
    const WorldPoint centre = centre_of(v);
    double least_sq = band_vox * band_vox, least = band_vox;
    int64_t nearest = 0;
    for (int64_t i = 0; i < count; ++i) {
      const MeshPoint place = nearest_within(centre, list[i], least);
      if (place.distance_sq >= least_sq || !triangles.counts(list[i], place)) continue;
      least_sq = place.distance_sq;
      least = std::sqrt(least_sq);
      nearest = i;
    }
    if (count > 0) swap(list[0], list[nearest]);
    return least;
  }

  ISOSHELL_HD static void swap(uint32_t& a, uint32_t& b) {
    const uint32_t was = a;
    a = b;
    b = was;
  }
};

}  // namespace isoshell::level_set_steps
