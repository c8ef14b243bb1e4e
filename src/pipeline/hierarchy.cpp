// Levels of seeds, coarse to fine.
#include "pipeline/hierarchy.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "core/copy_product.h"
#include "core/seed_count.h"
#include "isoshell/to_host.h"
#include "pipeline/choose_grid.h"
#include "pipeline/thin_walls.h"
#include "voxel/exact_int.h"

namespace isoshell {
namespace {

constexpr int kMaxLevels = 3;
constexpr int64_t kFewestSeeds = 64;  // of a level
constexpr int64_t kFewestPerComponent = 12;
constexpr int64_t kMostRepairPerMille = 60;
constexpr int64_t kFewestSeedsPerHandle = 50;   // that a coarse proxy has too many or too few
constexpr int64_t kFewestVerticesPerSeed = 24;  // of a coarse proxy: cells are nearly four voxels wide or more
constexpr int32_t kCoarsePasses = 60;
constexpr int32_t kCoarseTolerancePpb = 30000;
constexpr int32_t kCoarseSmoothingSteps = 40;
// Small levels, which cost little, relax again after their flips.
constexpr int64_t kMostSeedsTwice = 3000;
constexpr int32_t kPassesAgain = 30;
// Of the finest level after a coarser one. It ends early: the optimisation does the rest better than more passes.
constexpr int32_t kFinestPasses = 40;
constexpr int32_t kFinestTolerancePpb = 500000;

/// A triangulation with V vertices and Euler number chi has 4 V - 3 chi after one split.
int64_t coarser_count(int64_t count, const SheetTopology& topology) {
  const int64_t chi = 2 * (topology.components - topology.genus);
  return (count + 3 * chi) / 4;
}

/// Counts from coarse to fine, as long as a level has seeds enough.
std::vector<int64_t> level_counts(int64_t finest, const SheetTopology& sheet) {
  const int64_t fewest = std::max(kFewestSeeds, kFewestPerComponent * sheet.components);
  std::vector<int64_t> counts{finest};
  while (int(counts.size()) < kMaxLevels) {
    const int64_t coarser = coarser_count(counts.back(), sheet);
    if (coarser < fewest || coarser >= counts.back()) break;
    counts.push_back(coarser);
  }
  std::reverse(counts.begin(), counts.end());
  return counts;
}

/// Relaxes a coarse level. Returns its dual with as many vertices as it had seeds, flipped and smoothed, so that the
/// cells of the seeds that it is split into meet as its triangles do; none when the level is too coarse for the shape.
std::optional<SeededMesh> relax_coarse(const Sheet& sheet, const RelaxOptions& relax, SeedSet seeds, Context& context) {
  const int64_t asked = seeds.size();
  seeds = relax_on_sheet(sheet, std::move(seeds), relax, context).seeds;
  Triangulation dual = triangulate_dual(sheet, std::move(seeds), {}, context);
  if (dual.report.failed_cells > 0 || dual.seeds.size() - asked > asked * kMostRepairPerMille / 1000) return {};
  SeededMesh mesh = collapse_edges(sheet, std::move(dual), {asked}, context);
  OptimizeOptions optimize;
  optimize.smoothing_steps = kCoarseSmoothingSteps;
  optimize.for_seeds = true;
  return optimize_mesh(sheet, std::move(mesh), optimize, context);
}

/// Relaxes a level once, and again from there if it is small. The first round stands where cells are no disks after the
/// second one.
std::optional<SeededMesh> relax_level(const Sheet& sheet, const RelaxOptions& relax, SeedSet seeds, Context& context) {
  std::optional<SeededMesh> first = relax_coarse(sheet, relax, std::move(seeds), context);
  if (!first || first->seeds.size() > kMostSeedsTwice) return first;
  const RelaxOptions again{kPassesAgain, relax.tolerance_ppb, relax.max_step_q8};
  std::optional<SeededMesh> second = relax_coarse(sheet, again, to_host(first->seeds), context);
  return second ? std::move(second) : std::move(first);
}

/// How many cells of the smallest size would cover the sheet, over the number of its cells.
double crowding_of(const Sheet& sheet, Context& context) {
  if (sheet.lengths.at.empty()) return 1;
  const double voxel = sheet.frame.voxel_size, area_vox = sheet_area_world(sheet) / (voxel * voxel);
  return area_vox * 2 * kOneVoxelQ8 * kOneVoxelQ8 / double(seed_shares_q16(sheet, context));
}

/// What the levels relax on: the sheet for the finest, coarse proxies on coarser lattices for the others.
class CoarseProxies {
 public:
  CoarseProxies(const Prepared& prepared, const std::vector<int64_t>& counts, Context& context)
      : finest_(prepared.sheet) {
    halvings_.assign(counts.size(), 0);
    const SiteSet* sites = &solid_voxels_of(prepared);
    const double crowding = crowding_of(finest_, context);
    LatticeFrame frame = prepared.sheet.frame;
    int32_t closing_vox = closing_of_solid(prepared);
    for (int64_t level = int64_t(counts.size()) - 2; level >= 0; --level) {
      halvings_[size_t(level)] = int(proxies_.size());
      const double cells = crowding * double(counts[size_t(level)]);
      while (double((proxies_.empty() ? finest_ : proxies_.back()).vertex_count()) >=
             4 * kFewestVerticesPerSeed * cells) {
        SiteSet coarser = coarsen_sites(*sites, context);
        frame.voxel_size *= 2;
        frame.resolution = (frame.resolution + 1) / 2;
        for (int32_t& extent : frame.extent_vox) extent = (extent / 2 + 7) / 8 * 8;
        closing_vox = (closing_vox + 1) / 2;
        Sheet proxy = build_proxy(coarser, frame, {closing_vox, 0}, context);
        if (have_merged(proxy.topology, cells)) {
          std::fill(halvings_.begin(), halvings_.begin() + level + 1, int(proxies_.size()));
          return;
        }
        if (!finest_.lengths.at.empty())
          proxy.lengths = transfer_edge_lengths(finest_, int(proxies_.size()) + 1, proxy, context);
        sites_ = std::move(coarser);
        sites = &sites_;
        proxies_.push_back(std::move(proxy));
        halvings_[size_t(level)] = int(proxies_.size());
      }
    }
  }
  /// How many times the edge of the level's voxels was doubled.
  int halvings(size_t level) const { return halvings_[level]; }
  const Sheet& sheet(size_t level) const {
    return halvings_[level] == 0 ? finest_ : proxies_[size_t(halvings_[level]) - 1];
  }

 private:
  /// Whether near parts of the surface are one in the coarse proxy, or join in places by many handles.
  bool have_merged(const SheetTopology& proxy, double cells) const {
    const auto handles = double(std::abs(proxy.genus - finest_.topology.genus));
    return proxy.components != finest_.topology.components || handles * kFewestSeedsPerHandle > cells;
  }

  const Sheet& finest_;
  SiteSet sites_;  ///< of the coarsest proxy
  std::vector<Sheet> proxies_;
  std::vector<int> halvings_;
};

}  // namespace

RelaxedSeeds relax_by_levels(const Prepared& prepared, const SeedOptions& options, const RelaxOptions& relax,
                             bool tolerance_asked, Context& context) {
  require_seed_count(prepared.sheet, options.count);
  std::vector<int64_t> counts = level_counts(options.count, prepared.sheet.topology);
  RelaxOptions coarse = relax, finest = relax;
  coarse.max_passes = kCoarsePasses;
  if (!tolerance_asked) coarse.tolerance_ppb = kCoarseTolerancePpb;
  const CoarseProxies proxies(prepared, counts, context);
  for (size_t level = counts.size() - 1; level-- > 0;)  // coarse proxies may lack handles, or have more
    counts[level] = coarser_count(counts[level + 1], proxies.sheet(level).topology);
  SeedSet seeds;
  for (size_t level = 0; level + 1 < counts.size(); ++level) {
    const Sheet& sheet = proxies.sheet(level);
    if (seeds.size() == 0) seeds = place_seeds(sheet, {counts[level], options.seed}, context);
    const std::optional<SeededMesh> relaxed = relax_level(sheet, coarse, std::move(seeds), context);
    seeds = {};
    if (!relaxed) continue;
    seeds = subdivide_seeds(sheet, relaxed->mesh, relaxed->seeds, counts[level + 1], context);
    const int halvings = proxies.halvings(level) - proxies.halvings(level + 1);
    if (halvings > 0) seeds = attach_to_sheet(proxies.sheet(level + 1), std::move(seeds), halvings, context);
  }
  if (seeds.size() == 0) {
    seeds = place_seeds(prepared.sheet, options, context);
  } else {
    finest.max_passes = std::min(relax.max_passes, kFinestPasses);
    if (!tolerance_asked) finest.tolerance_ppb = kFinestTolerancePpb;
  }
  return relax_on_sheet(prepared.sheet, std::move(seeds), finest, context);
}

}  // namespace isoshell
