// See flag_gaps.h.
#include "pipeline/sheet/flag_gaps.h"

#include "core/copy_product.h"
#include "isoshell/gaps.h"
#include "pipeline/grid/thin_walls.h"

namespace isoshell {
namespace {

/// Grown walls have no source, and bridge nothing.
void leave_out_grown(const Sheet& of, const std::vector<uint8_t>& bridges, std::vector<uint8_t>& gaps) {
  const OnHost<Sheet> sheet(of);
  for (size_t v = 0; v < gaps.size(); ++v)
    if (sheet->source_triangle[int64_t(v)] == kNone) gaps[v] = !bridges.empty() && bridges[v];
}

}  // namespace

void flag_gaps(const PreparedSurface& p, View<const uint32_t> at, TriangleMesh& mesh, GapReport& report) {
  if (p.grown && !p.grown.only_flaps) return;
  std::vector<uint8_t> bridges;
  if (p.closing_vox > 0) {
    bridges = find_bridges(solid_voxels_of(p), p.sheet);
    measure_bridges(p.sheet, bridges, report);
    if (report.bridges == 0) bridges.clear();
  }
  std::vector<uint8_t> gaps = find_gaps(p.surface, p.sheet, bridges);
  if (p.grown.only_flaps) leave_out_grown(p.sheet, bridges, gaps);
  if (gaps.empty()) return;
  mesh.gap.resize(mesh.vertices.size());
  for (int64_t i = 0; i < at.size; ++i) report.vertices += mesh.gap[size_t(i)] = gaps[at[i]];
  report.area_world = gap_area_world(p.sheet, gaps);
}

}  // namespace isoshell
