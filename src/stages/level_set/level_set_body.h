// build_level_set (see level_set.h), written once over an executor.
//
// The voxels that may be in the band are known from the solid's boundary, by two dilations. Then every leaf lists the
// triangles that reach it, and measures; what the solid leaves open about sides is decided by paths along the lattice.
#pragma once

#include <algorithm>
#include <cmath>

#include "isoshell/advanced/level_set.h"
#include "stages/level_set/level_set_signs.h"

namespace isoshell {
namespace level_set_steps {

/// A voxel of the result has the value of the candidate that it was.
struct StoreLeaf {
  VoxelSetView candidates, band;
  View<const float> distance;
  View<const uint8_t> side;
  View<float> signed_distance;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    const uint32_t from = find_leaf(candidates, leaf_of_key(band.leaf_key[leaf]));
    for_each_active(band, leaf, [&](int offset, int64_t i) {
      const int64_t was = candidates.first[from] + rank_in_leaf(candidates.mask[from], offset);
      const bool is_inside = side[was] == kInside || side[was] == kPerhapsInside;
      signed_distance[i] = is_inside && distance[was] > 0 ? -distance[was] : distance[was];
    });
  }
};

/// The triangles that reach each leaf.
struct Lists {
  Buffer<int64_t> first;
  Buffer<uint32_t> triangle;
};

struct CountAsPlace {
  View<const uint32_t> count;
  View<int64_t> first;
  ISOSHELL_HD void operator()(int64_t i) const { first[i] = i < count.size ? count[i] : 0; }
};

template <class Exec>
Lists list_triangles(Exec& exec, const LeavesOfTriangle& near) {
  const int64_t leaves = near.leaves.leaf_key.size, triangles = near.triangles.count();
  Buffer<uint32_t> count = exec.template make<uint32_t>(leaves);
  exec.fill(count.view(), 0u);
  exec.for_each("count triangles", triangles, CountListed{near, count.view()});
  Lists lists{exec.template make<int64_t>(leaves + 1), {}};
  exec.for_each("places of lists", leaves + 1, CountAsPlace{count.view(), lists.first.view()});
  lists.triangle = exec.template make<uint32_t>(exec.exclusive_scan(lists.first.view()));
  exec.for_each("list triangles", triangles,
                ListTriangles{near, lists.first.view(), count.view(), lists.triangle.view()});
  return lists;
}

/// Sides of all candidates.
template <class Exec>
void find_sides(Exec& exec, const SideBySolid& by_solid, const BlockSteps& steps, int32_t rounds) {
  const VoxelSetView& candidates = steps.candidates;
  const View<uint8_t> side = by_solid.side;
  exec.for_each("sides by solid", candidates.leaf_key.size, by_solid);
  const Buffer<uint32_t> open = exec.select(side.size, IsOpen{side});
  exec.for_each("block steps", candidates.leaf_key.size, steps);
  Buffer<uint8_t> found = exec.template make<uint8_t>(open.size());
  for (int32_t round = 0; round < rounds; ++round) {
    exec.for_each("spread sides", open.size(), SpreadSides{candidates, open.view(), side, steps.blocked, found.view()});
    exec.for_each("take sides", open.size(), TakeSides{open.view(), found.view(), side});
  }
}

}  // namespace level_set_steps

template <class Exec>
LevelSet build_level_set_body(Exec& exec, View<const WorldPoint> triangle_corner, int64_t first_of_sheet,
                              const SiteSet& sites, const Sheet& sheet, const LevelSetOptions& options) {
  using namespace level_set_steps;
  using Dilate = typename Exec::Kernels::Dilate;
  LevelSet level_set;
  level_set.frame = sheet.frame;
  level_set.band_vox = options.band_vox;
  const int32_t* const extent = sheet.frame.extent_vox;

  Buffer<Voxel> corner = exec.template make<Voxel>(sheet.corners.voxel_count());
  exec.for_each("list corners", sheet.corners.leaf_count(), ListCorners{sheet.corners.view(), corner.view()});
  const BoundaryFaces faces{sheet.triangles.view(), corner.view()};
  const int32_t near_vox = std::max(options.closing_vox, 1) + 1;
  SiteSet rim, near_sheet, holding;
  rim.voxels = rim_of(exec, faces, extent);
  near_sheet.voxels = Dilate::run(exec, rim, near_vox);
  // Sites hold what counts of the input, and what is near the sheet holds the sheet, where that counts.
  const bool sheet_counts = 3 * first_of_sheet < triangle_corner.size;
  if (!sheet_counts) holding.voxels = intersection(exec, sites.voxels.view(), near_sheet.voxels.view());
  constexpr double kHalfDiagonal = 0.87;  // of a voxel, from whose centre the reach counts
  const VoxelSet candidate_set =
      Dilate::run(exec, sheet_counts ? near_sheet : holding, int32_t(std::ceil(options.band_vox + kHalfDiagonal)));
  const VoxelSetView candidates = candidate_set.view(), near_view = near_sheet.voxels.view();

  Buffer<Sphere> sphere = exec.template make<Sphere>(triangle_corner.size / 3);
  exec.for_each("spheres", sphere.size(), FindSphere{triangle_corner, first_of_sheet, near_view, sphere.view()});
  const Triangles triangles{triangle_corner, sphere.view(), near_view};
  Lists lists = list_triangles(exec, {triangles, candidates, options.band_vox});
  Buffer<float> distance = exec.template make<float>(candidate_set.voxel_count());
  Buffer<LeafMask> active = exec.template make<LeafMask>(candidate_set.leaf_count());
  exec.for_each("measure leaves", candidate_set.leaf_count(),
                MeasureLeaf{triangles, candidates, options.band_vox, lists.first.view(), lists.triangle.view(),
                            distance.view(), active.view()});

  const Buffer<uint64_t> rows = rows_of_solid(exec, faces);
  Buffer<uint8_t> side = exec.template make<uint8_t>(distance.size()),
                  blocked = exec.template make<uint8_t>(distance.size());
  find_sides(
      exec, {candidates, sites.voxels.view(), near_view, {rows.view()}, distance.view(), side.view()},
      {triangles, candidates, lists.first.view(), lists.triangle.view(), distance.view(), side.view(), blocked.view()},
      near_vox + 2);

  level_set.voxels = voxel_set_of(exec, candidates.leaf_key, active.view(), extent);
  level_set.distance_vox = exec.template make<float>(level_set.voxels.voxel_count());
  exec.for_each(
      "store leaves", level_set.voxels.leaf_count(),
      StoreLeaf{candidates, level_set.voxels.view(), distance.view(), side.view(), level_set.distance_vox.view()});
  return level_set;
}

}  // namespace isoshell
