#include "pipeline/grid/thin_walls.h"

#include <algorithm>

namespace isoshell {
namespace {

constexpr double kThicknessPerEdge = 0.8;  // at half of it angles at rims fall to 22 degrees here and there

}  // namespace

int32_t growth_for_edge(double edge_vox) {
  return std::clamp(int32_t(kThicknessPerEdge * edge_vox / 2), 1, kMostGrownVox);
}

void grow_solid(PreparedSurface& p, int32_t grown_vox, int64_t smallest_component_q16, Context& context) {
  p.sheet = {};
  p.grown.distance_vox = grown_vox;
  p.grown.voxels.voxels = build_shell(p.sites, {grown_vox}, context).voxels;
  const SheetOptions options{closing_of_solid(p), smallest_component_q16, kNoGenus, false};
  p.sheet = build_proxy(p.grown.voxels, p.surface.frame, options, context);
  p.sheet.topology.bridged_vertices = 0;  // a coarse proxy has no sources
}

}  // namespace isoshell
