// See dual_of_seeds.h.
#include "pipeline/sheet/dual_of_seeds.h"

namespace isoshell {
namespace {

/// How seeds relax after a repair that took many.
struct Again {
  int32_t passes;
  int most_times;
};
constexpr Again kOnSheet{20, 4};
constexpr Again kBetweenFixed{3, 6};       // more passes take seeds back to where cells need the same repair
constexpr int64_t kFewRepairPerMille = 5;  // the mesh takes these without relaxing again

}  // namespace

DualReport make_dual_of_seeds(const SurfaceMesh& surface, const CollapseOptions& count, SeededMesh& made, Run& run) {
  DualReport sum;
  const Again again = made.seeds.fixed.count > 0 ? kBetweenFixed : kOnSheet;
  for (int round = 0;; ++round) {
    Triangulation dual =
        run.timed("dual", [&] { return triangulate_dual(surface, std::move(made.seeds), {}, run.context); });
    const DualReport found = dual.report;
    sum.inserted_seeds += found.inserted_seeds;
    sum.relabelled_vertices += found.relabelled_vertices;
    sum.repair_rounds += found.repair_rounds;
    sum.failed_cells = found.failed_cells;
    made = std::move(dual);
    if (found.failed_cells == 0)
      made = run.timed("dual", [&] { return collapse_edges(surface, std::move(made), count, run.context); });
    if (found.inserted_seeds <= count.target * kFewRepairPerMille / 1000 || round == again.most_times) return sum;
    made.seeds = run.timed("relax", [&] {
      return relax_on_sheet(surface, std::move(made.seeds), {again.passes, 0, 0}, run.context).seeds;
    });
  }
}

}  // namespace isoshell
