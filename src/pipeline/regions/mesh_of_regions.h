// The mesh of a run that parts regions.
#pragma once

#include "pipeline/patches/patches.h"

namespace isoshell {

/// As triangulate_patches, of walls: every region is closed, and the faces say which regions they part. Where patches
/// are no disks, or triangles intersect, these are coarsened instead (see mend_patches.h), or all walls, to as many
/// vertices (see coarsen_walls.h); where they intersect as they came in they stay so. The report says so.
TriangleMesh triangulate_regions(const PreparedSurface& p, SeededMesh& made, const PatchOptions& in_patches,
                                 RemeshReport& report, Run& run);

}  // namespace isoshell
