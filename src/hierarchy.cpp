// Levels of seeds, coarse to fine.
#include "hierarchy.h"

#include <algorithm>
#include <vector>

namespace isoshell {
namespace {

constexpr int kMaxLevels = 3;
constexpr int64_t kFewestSeeds = 64;          // of a level
constexpr int64_t kFewestPerComponent = 12;
constexpr int64_t kMostRepairPerMille = 5;
constexpr int32_t kCoarsePasses = 60;
constexpr int32_t kFinestPasses = 40;         // after a coarser level; without one the caller's own number

/// Counts from coarse to fine. A triangulation with V vertices and Euler number chi has 4 V - 3 chi after one split.
std::vector<int64_t> level_counts(int64_t finest, const SheetTopology& sheet) {
  const int64_t chi = 2 * (sheet.components - sheet.genus);
  const int64_t fewest = std::max(kFewestSeeds, kFewestPerComponent * sheet.components);
  std::vector<int64_t> counts{finest};
  while (int(counts.size()) < kMaxLevels) {
    const int64_t coarser = (counts.back() + 3 * chi) / 4;
    if (coarser < fewest || coarser >= counts.back()) break;
    counts.push_back(coarser);
  }
  std::reverse(counts.begin(), counts.end());
  return counts;
}

/// Dual of a coarse level with its flips done; null triangles when the level is too coarse for the shape.
DualMesh coarse_dual(const Sheet& sheet, SeedSet& seeds, Context& context) {
  const int64_t asked = seeds.size();
  DualReport report;
  DualMesh mesh = triangulate_dual(sheet, seeds, {}, report, context);
  if (report.failed_cells > 0 || seeds.size() - asked > asked * kMostRepairPerMille / 1000) return {};
  improve_mesh(sheet, {1, 6, 0}, seeds, mesh, context);
  return mesh;
}

}  // namespace

SeedSet relax_by_levels(const Sheet& sheet, const SeedOptions& options, const RelaxOptions& relax, RelaxReport& report,
                        Context& context) {
  const std::vector<int64_t> counts = level_counts(options.count, sheet.topology);
  const RelaxOptions coarse{kCoarsePasses, relax.tolerance_ppb, relax.max_step_q8};
  SeedSet seeds;
  for (size_t level = 0; level + 1 < counts.size(); ++level) {
    if (seeds.size() == 0) seeds = place_seeds(sheet, {counts[level], options.seed}, context);
    relax_on_sheet(sheet, seeds, coarse, context);
    const DualMesh dual = coarse_dual(sheet, seeds, context);
    seeds = dual.triangles.empty() ? SeedSet{} : subdivide_seeds(sheet, dual, seeds, counts[level + 1], context);
  }
  RelaxOptions finest = relax;
  if (seeds.size() == 0) seeds = place_seeds(sheet, options, context);
  else finest.max_passes = std::min(finest.max_passes, kFinestPasses);
  report = relax_on_sheet(sheet, seeds, finest, context);
  return seeds;
}

}  // namespace isoshell
