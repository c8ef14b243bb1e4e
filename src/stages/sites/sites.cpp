// voxelize: checks its arguments, then runs on the backend that the context asks for.
#include <algorithm>
#include <string>

#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {
namespace {

// Cells beyond the lattice would be cut off without a word, and larger coordinates exceed the budget of
// voxel/overlap.h.
void require_inside(const LatticeSurface& surface) {
  if (surface.triangles.empty())
    throw Error(ErrorCode::nothing_to_mesh, "sites", "the surface has 0 triangles; a mesh needs at least 1");
  const int32_t* extent = surface.frame.extent_vox;
  const int32_t largest = std::max({extent[0], extent[1], extent[2]});
  if (largest > kMaxExtentVox || std::min({extent[0], extent[1], extent[2]}) < 1)
    throw Error(ErrorCode::usage, "sites",
                "the lattice is " + std::to_string(largest) + " voxels wide; each side must be 1 to " +
                    std::to_string(kMaxExtentVox));
  if (surface.points.space() != MemorySpace::host) return;  // made by snap_surface, which keeps inside
  for (PointQ8 p : surface.points)
    if (p.x < 1 || p.y < 1 || p.z < 1 || p.x >= extent[0] * kOneVoxelQ8 || p.y >= extent[1] * kOneVoxelQ8 ||
        p.z >= extent[2] * kOneVoxelQ8)
      throw Error(ErrorCode::usage, "sites",
                  "a point of the surface is outside the lattice; make the frame from the surface's bounding box");
}

}  // namespace

SiteSet voxelize(const LatticeSurface& surface, Context& context) {
  require_inside(surface);
  return backend_for(context).voxelize(surface, context);
}

}  // namespace isoshell
