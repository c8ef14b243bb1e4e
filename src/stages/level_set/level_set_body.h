// build_level_set (see level_set.h), written once over an executor.
//
// The voxels that may be in the band are known from the solid's boundary, by two dilations. Then every leaf lists the
// triangles that reach it, and measures; what the solid leaves open about sides is decided by paths along the lattice.
#pragma once

#include <algorithm>
#include <cmath>

#include "isoshell/advanced/level_set.h"
#include "stages/level_set/level_set_distances.h"
#include "stages/level_set/level_set_signs.h"
#include "stages/sparse/reach.h"

namespace isoshell {
namespace level_set_steps {

/// A voxel of the result has the value of the candidate that it was.
struct StorePlane {
  VoxelSetView candidates, band;
  View<const float> distance;
  View<const LeafMask> inside;
  View<float> signed_distance;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t leaf = i >> 3;
    const int x = int(i & 7);
    const uint32_t from = find_leaf(candidates, leaf_of_key(band.leaf_key[leaf]));
    const uint64_t all = band.mask[leaf].word[x], were = candidates.mask[from].word[x], inner = inside[from].word[x];
    int64_t to = band.first[leaf] + rank_of_plane(band.mask[leaf], x);
    const int64_t was = candidates.first[from] + rank_of_plane(candidates.mask[from], x);
    for (uint64_t bits = all; bits; bits &= bits - 1) {
      const uint64_t bit = bits & ~(bits - 1);
      const float value = distance[was + popcount64(were & (bit - 1))];
      signed_distance[to++] = (inner & bit) != 0 && value > 0 ? -value : value;
    }
  }
};

}  // namespace level_set_steps

template <class Exec>
LevelSet build_level_set_body(Exec& exec, const LevelSetSurface& surface, const SiteSet& sites, const Sheet& sheet,
                              const LevelSetOptions& options) {
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
  const bool sheet_counts = 3 * surface.first_of_sheet < surface.corner.size();
  if (!sheet_counts) holding.voxels = intersection(exec, sites.voxels.view(), near_sheet.voxels.view());
  constexpr double kHalfDiagonal = 0.87;  // of a voxel, from whose centre the reach counts
  const VoxelSet candidate_set =
      Dilate::run(exec, sheet_counts ? near_sheet : holding, int32_t(std::ceil(options.band_vox + kHalfDiagonal)));
  const VoxelSetView candidates = candidate_set.view(), near_view = near_sheet.voxels.view();

  Buffer<Disc> disc = exec.template make<Disc>(surface.corner.size() / 3);
  exec.for_each("discs", disc.size(), FindDisc{surface.corner.view(), surface.first_of_sheet, near_view, disc.view()});
  const Triangles triangles{surface.corner.view(), disc.view(), near_view};
  Lists lists = list_triangles(exec, {triangles, candidates, options.band_vox});
  Buffer<float> distance = exec.template make<float>(candidate_set.voxel_count());
  Buffer<LeafMask> active = exec.template make<LeafMask>(candidate_set.leaf_count());
  exec.for_each("measure leaves", candidate_set.leaf_count(),
                MeasureLeaf{triangles, candidates, options.band_vox, lists.first.view(), lists.triangle.view(),
                            distance.view(), active.view()});
  const Buffer<uint64_t> rows = rows_of_solid(exec, faces);
  const Buffer<LeafMask> inside = find_inside(exec, triangles, lists, candidates, sites.voxels.view(), {rows.view()},
                                              distance.view(), near_vox + 2);

  level_set.voxels = voxel_set_of(exec, candidates.leaf_key, active.view(), extent);
  level_set.distance_vox = exec.template make<float>(level_set.voxels.voxel_count());
  exec.for_each(
      "store planes", 8 * level_set.voxels.leaf_count(),
      StorePlane{candidates, level_set.voxels.view(), distance.view(), inside.view(), level_set.distance_vox.view()});
  return level_set;
}

}  // namespace isoshell
