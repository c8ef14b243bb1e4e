// See resolve_intersections.h.
#include "pipeline/sheet/resolve_intersections.h"

#include "core/copy_product.h"

namespace isoshell {
namespace {

constexpr int kTriesOfFewerRounds = 4;

/// With the cells of triangles that intersect split. Where a split leaves cells that no other one repairs, those before
/// it count: the rounds are halved until all cells are disks.
Triangulation split_where_crossing(const SurfaceMesh& surface, const SeedSet& seeds, Context& context) {
  DualOptions split;
  split.most_against_crossing = seeds.size();
  Triangulation dual;
  for (int tries = kTriesOfFewerRounds; tries >= 0; --tries) {
    dual = triangulate_dual(surface, host_copy(seeds), split, context);
    if (dual.report.failed_cells == 0) break;
    split.max_repair_rounds = dual.report.repair_rounds / 2;
  }
  return dual;
}

/// From `seeds` as many as `mesh` has.
void make_again(const SurfaceMesh& surface, const SeedSet& seeds, const OptimizeOptions& options, bool keep_ids,
                SeededMesh& mesh, RemeshReport& report, Context& context) {
  const int64_t requested = mesh.seeds.size();
  Triangulation dual = split_where_crossing(surface, seeds, context);
  const DualReport found = dual.report;
  if (found.failed_cells > 0) return;
  SeededMesh again = collapse_edges(surface, std::move(dual), {requested, true, keep_ids}, context);
  again = collapse_edges(surface, std::move(again), {requested, false, keep_ids},
                         context);  // the count goes before what is left
  if (again.seeds.size() != requested) return;
  OptimizeOptions careful = options;
  careful.keep_apart = true;
  OptimizedMesh optimized = optimize_mesh(surface, std::move(again), careful, context);
  if (optimized.report.self_intersections >= report.optimize.self_intersections) return;
  report.optimize = optimized.report;
  report.seeds_against_intersections = found.inserted_seeds;
  mesh = std::move(optimized);
}

}  // namespace

void resolve_intersections(const PreparedSurface& prepared, const OptimizeOptions& options, bool keep_ids,
                           SeededMesh& mesh, RemeshReport& report, Context& context) {
  UntangledSheet start = untangle_sheet(host_copy(prepared.sheet), host_copy(mesh.seeds), context);
  make_again(start.sheet, start.seeds, options, keep_ids, mesh, report, context);
}

}  // namespace isoshell
