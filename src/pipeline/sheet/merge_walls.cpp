// See merge_walls.h.
#include "pipeline/sheet/merge_walls.h"

#include <algorithm>
#include <sstream>

#include "core/copy_product.h"
#include "pipeline/grid/choose_grid.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/grid/thin_walls.h"
#include "pipeline/sheet/flaps.h"

namespace isoshell {
namespace {

constexpr int32_t kMostGrownVox = 9;  // as of thin walls: fits into the lattice's margin

}  // namespace

MergedWalls merge_walls(const Prepared& prepared, const std::vector<PointQ8>& points, int times_before,
                        const RemeshOptions& options, Context& context) {
  MergedWalls merged;
  Prepared& p = merged.prepared;
  p.surface = host_copy(prepared.surface);
  p.sites = host_copy(prepared.sites);
  p.sheet = host_copy(prepared.sheet);
  p.closing_vox = prepared.closing_vox;
  p.vertices = prepared.vertices;
  p.grown = {prepared.grown.distance_vox, prepared.grown.only_flaps, host_copy(prepared.grown.voxels)};
  const double edge_vox = usual_edge_length(options, sheet_area_world(p.sheet)) / p.surface.frame.voxel_size;
  merged.grown_vox = std::min(std::max(1, growth_for_edge(edge_vox) / 4) << times_before, kMostGrownVox);
  grow_at(p, sites_near(p.sites, points, edge_vox), merged.grown_vox,
          smallest_component_q16(options, p.surface.topology, p.surface.frame), context);
  RemeshReport unsaid;
  set_lengths(options, p, unsaid, context);
  return merged;
}

void report_merge(const MergedWalls& merged, const std::vector<PointQ8>& points, RemeshReport& report) {
  const Prepared& p = merged.prepared;
  report.merged = {merged.grown_vox, int64_t(points.size()), p.surface.frame.to_world(points.front())};
  report.sheet = p.sheet.topology;
  report.sheet_vertices = p.sheet.vertex_count();
  const InputTopology& input = p.surface.topology;
  report.topology_agrees =
      report.topology_compared && report.sheet.components == input.components && report.sheet.genus == input.genus;
  std::ostringstream text;
  text << "walls nearer to one another than edges can follow were merged, grown by "
       << merged.grown_vox * p.surface.frame.voxel_size << " to each side, near " << report.merged.at.x << ' '
       << report.merged.at.y << ' ' << report.merged.at.z << "; more --vertices tell them apart";
  report.warnings.push_back(text.str());
}

}  // namespace isoshell
