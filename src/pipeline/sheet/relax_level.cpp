// See relax_level.h.
#include "pipeline/sheet/relax_level.h"

#include <algorithm>

#include "core/copy_product.h"

namespace isoshell {
namespace {

constexpr int64_t kMostRepairPerMille = 60;
constexpr int32_t kCoarsePasses = 60;
constexpr int32_t kCoarseTolerancePpb = 30000;
constexpr int32_t kCoarseSmoothingSteps = 40;
// Of the finest level after a coarser one. It ends early: the optimisation does the rest better than more passes.
constexpr int32_t kFinestPasses = 40;
constexpr int32_t kFinestTolerancePpb = 500000;

}  // namespace

std::optional<SeededMesh> relax_level(const SurfaceMesh& surface, const RelaxOptions& relax, SeedSet seeds,
                                      Context& context) {
  const int64_t requested = seeds.size();
  seeds = relax_on_sheet(surface, std::move(seeds), relax, context).seeds;
  Triangulation dual = triangulate_dual(surface, std::move(seeds), {}, context);
  if (dual.report.failed_cells > 0 || dual.seeds.size() - requested > requested * kMostRepairPerMille / 1000) return {};
  SeededMesh mesh = collapse_edges(surface, std::move(dual), {requested}, context);
  OptimizeOptions optimize;
  optimize.smoothing_steps = kCoarseSmoothingSteps;
  optimize.for_seeds = true;
  return optimize_mesh(surface, std::move(mesh), optimize, context);
}

RelaxOptions for_coarse_level(RelaxOptions relax, bool tolerance_requested) {
  relax.max_passes = kCoarsePasses;
  if (!tolerance_requested) relax.tolerance_ppb = kCoarseTolerancePpb;
  return relax;
}
RelaxOptions for_finest_level(RelaxOptions relax, bool tolerance_requested) {
  relax.max_passes = std::min(relax.max_passes, kFinestPasses);
  if (!tolerance_requested) relax.tolerance_ppb = kFinestTolerancePpb;
  return relax;
}

}  // namespace isoshell
