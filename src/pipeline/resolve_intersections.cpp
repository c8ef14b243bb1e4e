// See resolve_intersections.h.
#include "pipeline/resolve_intersections.h"

#include "core/copy_product.h"

namespace isoshell {

void resolve_intersections(const Prepared& prepared, const OptimizeOptions& options, SeedSet& seeds, DualMesh& mesh,
                           RemeshReport& report, Context& context) {
  const int64_t asked = seeds.size();
  Sheet sheet = host_copy(prepared.sheet);
  SeedSet start = host_copy(seeds);
  untangle_sheet(sheet, start, context);
  DualOptions split;
  split.most_against_crossing = asked;
  DualReport found;
  DualMesh dual = triangulate_dual(sheet, start, split, found, context);
  if (found.failed_cells > 0) return;
  const bool keep_apart = true;
  collapse_edges(sheet, asked, start, dual, context, keep_apart);
  collapse_edges(sheet, asked, start, dual, context);  // the count goes before what is left
  if (start.size() != asked) return;
  OptimizeOptions again = options;
  again.keep_apart = true;
  const OptimizeReport optimize = optimize_mesh(sheet, again, start, dual, context);
  if (optimize.self_intersections >= report.post.self_intersections) return;
  seeds = std::move(start);
  mesh = std::move(dual);
  report.post = optimize;
  report.seeds_against_intersections = found.inserted_seeds;
}

}  // namespace isoshell
