// See resolve_intersections.h.
#include "pipeline/resolve_intersections.h"

#include "core/copy_product.h"

namespace isoshell {

void resolve_intersections(const Prepared& prepared, const OptimizeOptions& options, SeededMesh& mesh,
                           RemeshReport& report, Context& context) {
  const int64_t asked = mesh.seeds.size();
  UntangledSheet start = untangle_sheet(host_copy(prepared.sheet), host_copy(mesh.seeds), context);
  const Sheet& sheet = start.sheet;
  DualOptions split;
  split.most_against_crossing = asked;
  Triangulation dual = triangulate_dual(sheet, std::move(start.seeds), split, context);
  const DualReport found = dual.report;
  if (found.failed_cells > 0) return;
  SeededMesh again = collapse_edges(sheet, std::move(dual), {asked, true}, context);
  again = collapse_edges(sheet, std::move(again), {asked}, context);  // the count goes before what is left
  if (again.seeds.size() != asked) return;
  OptimizeOptions careful = options;
  careful.keep_apart = true;
  OptimizedMesh optimized = optimize_mesh(sheet, std::move(again), careful, context);
  if (optimized.report.self_intersections >= report.post.self_intersections) return;
  report.post = optimized.report;
  report.seeds_against_intersections = found.inserted_seeds;
  mesh = std::move(optimized);
}

}  // namespace isoshell
