// attach_to_sheet (see stages.h), written once over an executor.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sheet/sheet_walk.h"
#include "stages/sparse/vertex_grid_body.h"
#include "voxel/proxy_depth.h"

namespace isoshell {
namespace attach_seeds {

struct AttachSeed {
  VertexGridView vertices;
  WalkOntoSheet walk;
  int halvings;
  View<PointQ8> position;
  View<Normal8> normal;
  View<uint32_t> home;
  ISOSHELL_HD void operator()(int64_t i) const {
    const PointQ8 p = where_from(i);
    const uint32_t vertex = nearest_vertex(vertices, p).id;
    home[i] = vertex;
    normal[i] = walk.normal[vertex];
    position[i] = walk.closest_around(vertex, p);
  }
  /// Seeds of a coarse proxy come from outside, so that they find the right side of a thin wall.
  ISOSHELL_HD PointQ8 where_from(int64_t i) const {
    const PointQ8 p = {position[i].x << halvings, position[i].y << halvings, position[i].z << halvings};
    return halvings == 0 ? p : moved_by_proxy_depth(p, normal[i], kOneVoxelQ8 << halvings);
  }
};

}  // namespace attach_seeds

template <class Exec>
void attach_to_sheet_body(Exec& exec, const SurfaceMesh& surface, SeedSet& seeds, int halvings) {
  const VertexGrid grid(exec, surface);
  const WalkOntoSheet walk = walk_onto(surface);
  exec.for_each("attach seeds", seeds.size(),
                attach_seeds::AttachSeed{grid.view(), walk, halvings, seeds.position.view(), seeds.normal.view(),
                                         seeds.home.view()});
}

}  // namespace isoshell
