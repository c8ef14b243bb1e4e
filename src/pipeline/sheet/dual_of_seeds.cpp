// See dual_of_seeds.h.
#include "pipeline/sheet/dual_of_seeds.h"

#include "pipeline/grid/timed.h"

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

void make_dual_of_seeds(const SurfaceMesh& surface, const CollapseOptions& count, SeededMesh& made,
                        RemeshReport& report, Context& context) {
  report.dual = {};
  const Again again = made.seeds.fixed.count > 0 ? kBetweenFixed : kOnSheet;
  for (int round = 0;; ++round) {
    Triangulation dual =
        timed(report, "dual", context, [&] { return triangulate_dual(surface, std::move(made.seeds), {}, context); });
    const DualReport found = dual.report;
    report.dual.inserted_seeds += found.inserted_seeds;
    report.dual.relabelled_vertices += found.relabelled_vertices;
    report.dual.repair_rounds += found.repair_rounds;
    report.dual.failed_cells = found.failed_cells;
    made = std::move(dual);
    if (found.failed_cells == 0)
      made = timed(report, "dual", context, [&] { return collapse_edges(surface, std::move(made), count, context); });
    if (found.inserted_seeds <= count.target * kFewRepairPerMille / 1000 || round == again.most_times) return;
    made.seeds = timed(report, "relax", context, [&] {
      return relax_on_sheet(surface, std::move(made.seeds), {again.passes, 0, 0}, context).seeds;
    });
  }
}

}  // namespace isoshell
