// The walls between regions as a run has them.
#pragma once

#include <map>

#include "features/mesh/feature_mesh.h"
#include "isoshell/regions.h"
#include "pipeline/grid/prepared_surface.h"
#include "pipeline/grid/run_log.h"

namespace isoshell {

/// Every wall once. `mesh.source_face` says of which face of `regions` each triangle is.
struct RegionWalls {
  FeatureMesh mesh;
  FaceRegions regions;
  /// Of voxels: six times the volume of each region, faired, and the background's, modulo 2^64, by its label.
  std::map<int32_t, uint64_t> spanned_volume_q8 = {};
  bool are_too_near = false;  ///< for edges as long as asked for: relaxed triangles would intersect, so none are

  const std::array<int32_t, 2>& labels_of(size_t triangle) const { return regions.labels[mesh.source_face[triangle]]; }
};

/// Cuts the walls along the curves where three regions or more meet, and along the creases that the options ask for:
/// the grid and the surface of a run that parts regions. As many vertices as the options ask for, or as few as the
/// curves take. Throws: nothing_to_mesh, usage, out_of_memory, interrupted.
PreparedSurface prepare_regions(const TriangleSoup& soup, const RemeshOptions& checked_options, Run& run);

}  // namespace isoshell
