// The part of build_sheet that remembers what the sheet misses: points of a closed surface in pits and grooves
// finer than a voxel, which the solid fills.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sheet/sheet_walk.h"
#include "stages/sparse/vertex_grid_body.h"

namespace isoshell {

constexpr int64_t kOffSurfaceQ8 = kOneVoxelQ8 / 2;     ///< points nearer to the sheet are on it, for its purposes
constexpr int64_t kFarOffSurfaceQ8 = 4 * kOneVoxelQ8;  ///< points farther from it belong to what it leaves out

namespace sheet_steps {

/// Nearest sheet vertex of a point that the sheet misses, kNone for others.
struct FindOffSurface {
  VertexGridView vertices;
  WalkOntoSheet sheet;
  View<const PointQ8> point;
  View<uint32_t> near;
  ISOSHELL_HD void operator()(int64_t i) const {
    const NearestVertex v = nearest_vertex(vertices, point[i]);
    near[i] = kNone;
    if (v.distance_sq_q16 <= kOffSurfaceQ8 * kOffSurfaceQ8) return;
    const int64_t off = distance_sq_q16(point[i], sheet.closest_around(v.id, point[i]));
    if (off > kOffSurfaceQ8 * kOffSurfaceQ8 && off <= kFarOffSurfaceQ8 * kFarOffSurfaceQ8) near[i] = v.id;
  }
};
struct IsOffSurface {
  View<const uint32_t> near;
  ISOSHELL_HD bool operator()(int64_t i) const { return near[i] != kNone; }
};
struct CopyOffSurface {
  View<const uint32_t> chosen;
  View<const PointQ8> point;
  View<const uint32_t> near;
  View<PointQ8> missed;
  View<uint32_t> vertex;
  ISOSHELL_HD void operator()(int64_t i) const {
    missed[i] = point[chosen[i]];
    vertex[i] = near[chosen[i]];
  }
};

}  // namespace sheet_steps

template <class Exec>
void find_off_surface(Exec& exec, const LatticeSurface& surface, SurfaceMesh& sheet) {
  using namespace sheet_steps;
  const VertexGrid grid(exec, sheet);
  const WalkOntoSheet walk = walk_onto(sheet);
  Buffer<uint32_t> near = exec.template make<uint32_t>(surface.points.size());
  exec.for_each("find missed points", surface.points.size(),
                FindOffSurface{grid.view(), walk, surface.points.view(), near.view()});
  const Buffer<uint32_t> chosen = exec.select(surface.points.size(), IsOffSurface{near.view()});
  sheet.missed = exec.template make<PointQ8>(chosen.size());
  sheet.missed_vertex = exec.template make<uint32_t>(chosen.size());
  exec.for_each("copy missed points", chosen.size(),
                CopyOffSurface{chosen.view(), surface.points.view(), near.view(), sheet.missed.view(),
                               sheet.missed_vertex.view()});
}

}  // namespace isoshell
