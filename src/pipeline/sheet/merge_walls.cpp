// See merge_walls.h.
#include "pipeline/sheet/merge_walls.h"

#include <algorithm>
#include <sstream>

#include "core/copy_product.h"
#include "isoshell/readable.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/grid/thin_walls.h"
#include "pipeline/sheet/flaps.h"

namespace isoshell {

MergedWalls merge_walls(const PreparedSurface& prepared, const std::vector<PointQ8>& points, int times_before,
                        Context& context) {
  MergedWalls merged;
  PreparedSurface& p = merged.prepared;
  p = begin_with(host_copy(prepared.surface), prepared.options);
  p.options.method = Method::sheet;  // whatever it was: there is no shell of the merged solid
  p.sites = host_copy(prepared.sites);
  p.sheet = host_copy(prepared.sheet);
  p.closing_vox = prepared.closing_vox;
  p.vertices_of_lengths = prepared.vertices_of_lengths;
  p.grown = {prepared.grown.distance_vox, prepared.grown.only_flaps, host_copy(prepared.grown.voxels)};
  const double edge_vox = edge_length_on_sheet_world(p) / p.surface.frame.voxel_size;
  merged.grown_vox = std::min(std::max(1, growth_for_edge(edge_vox) / 4) << times_before, kMostGrownVox);
  grow_at(p, sites_near(p.sites, points, edge_vox), merged.grown_vox, smallest_component_q16(p), context);
  set_lengths(p, context);
  return merged;
}

void report_merge(const MergedWalls& merged, const std::vector<PointQ8>& points, RemeshReport& report) {
  const PreparedSurface& p = merged.prepared;
  report.merged = {merged.grown_vox, int64_t(points.size()), p.surface.frame.to_world(points.front())};
  report.sheet.topology = p.sheet.topology;
  report.sheet.vertices = p.sheet.vertex_count();
  const InputTopology& input = p.surface.topology;
  report.sheet.agrees = report.sheet.is_compared && report.sheet.topology.components == input.components &&
                        report.sheet.topology.genus == input.genus;
  std::ostringstream text;
  text << "walls nearer to one another than edges can follow were merged, grown by "
       << merged.grown_vox * p.surface.frame.voxel_size << " to each side, near "
       << readable_place(report.merged.at, p.surface.frame) << "; more --vertices tell them apart";
  report.warnings.push_back(text.str());
}

}  // namespace isoshell
