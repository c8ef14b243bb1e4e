// See mend_sheet.h.
#include "pipeline/patches/mend_sheet.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/copy_product.h"
#include "features/mesh/refine_mesh.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/patches/cut_curves.h"
#include "pipeline/patches/feature_report.h"

namespace isoshell {
namespace {

/// The triangles of a sheet, which are finer than any cell.
std::shared_ptr<const FineMesh> fine_mesh_of(const SurfaceMesh& surface) {
  auto fine = std::make_shared<FineMesh>();
  for (const PointQ8& p : surface.position) fine->position.push_back({double(p.x), double(p.y), double(p.z)});
  for (const TriangleIndices& t : surface.triangles) fine->triangles.push_back({t.a, t.b, t.c});
  return fine;
}

/// From ratios to lattice steps.
void scale_lengths(double steps, EdgeLengths& lengths) {
  const auto scaled = [&](uint32_t length) { return uint32_t(std::llround(std::max(1., length * steps))); };
  for (uint32_t& length : lengths.at) length = scaled(length);
  lengths.least = scaled(lengths.least);
  lengths.largest = scaled(lengths.largest);
}

/// One patch without curves.
CutSurface cut_of(Sheet sheet, int64_t vertices, double edge_length_world, Context& context) {
  CutSurface cut;
  cut.frame = sheet.frame;
  cut.longest_edge_q8 = edge_length_world / sheet.frame.voxel_size * kOneVoxelQ8;
  cut.is_requested = !sheet.lengths.at.empty();
  if (cut.is_requested) {
    scale_lengths(edge_of_length(sheet, vertices, context), sheet.lengths);
    cut.longest_edge_q8 = double(sheet.lengths.largest);
  }
  cut.fine = fine_mesh_of(sheet);
  for (const TriangleIndices& t : sheet.triangles) cut.corner.insert(cut.corner.end(), {t.a, t.b, t.c});
  sheet.patch = Buffer<uint32_t>(sheet.vertex_count());
  std::fill(sheet.patch.begin(), sheet.patch.end(), 0);
  cut.place.assign(size_t(sheet.vertex_count()), kNone);
  cut.copies_first = {0};
  cut.seeds = vertices;
  auto source = std::make_shared<CutSource>();
  source->is_sheet = true;
  cut.source = std::move(source);
  cut.surface = std::move(sheet);
  return cut;
}

}  // namespace

std::optional<MendedPatches> mend_sheet(const PreparedSurface& p, const SeededMesh& made,
                                        const OptimizeReport& optimized, const PatchOptions& options, Run& run) {
  UntangledSheet start =
      run.timed("untangle", [&] { return untangle_sheet(host_copy(p.sheet), host_copy(made.seeds), run.context); });
  if (start.self_intersections > 0) return {};
  on_host(start.seeds);
  const CutSurface cut =
      cut_of(std::move(on_host(start.sheet)), options.seeds.count, edge_length_on_sheet_world(p), run.context);
  PatchFaults none_optimized;
  none_optimized.optimize = optimized;
  none_optimized.optimized = {std::move(start.seeds), {}, {0}};
  std::optional<MendedPatches> mended = mend_patches(p, cut, none_optimized, options, run);
  if (!mended) return {};
  measure_edges(cut, mended->joined, mended->sizing);
  warn_of_left_alone(mended->joined.left_alone, run);
  return mended;
}

}  // namespace isoshell
