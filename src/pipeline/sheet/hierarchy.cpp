// Levels of seeds, coarse to fine.
#include "pipeline/sheet/hierarchy.h"

#include <algorithm>
#include <vector>

#include "core/seed_count.h"
#include "core/stage_share.h"
#include "pipeline/grid/thin_walls.h"
#include "voxel/exact_int.h"

namespace isoshell {
namespace {

constexpr int64_t kMostRepairPerMille = 60;
constexpr int32_t kCoarseTolerancePpb = 30000;
constexpr int32_t kCoarseSmoothingSteps = 40;
// Passes of coarse levels on the sheet bring seeds to tips and rims. Those on their mesh after them cost a tenth, but
// make edges as long everywhere.
constexpr int32_t kCoarsePasses = 30, kCoarsePassesAlone = 60;
constexpr int32_t kCoarseMeshPasses = 40;
// Random seeds are annealed: irregular vertices that cancel out there are missing on all levels above.
constexpr int32_t kAnnealingPasses = 240;
constexpr double kAnnealingNoiseEdges = 0.08;
constexpr int64_t kMostSeedsOfCoarsest = 2400;  ///< a quarter of that is enough for most shapes, and less is not
// Of the finest level after a coarser one. It ends early: the optimisation does the rest better than more passes, but
// seeds take longer to where lengths want them.
constexpr int32_t kFinestPasses = 40;
constexpr int32_t kFinestTolerancePpb = 1000000, kFinestTolerancePpbOfLengths = 500000;

constexpr int64_t kFewestSeedsPerHandle = 50;   // that a coarse proxy has too many or too few
constexpr int64_t kFewestVerticesPerSeed = 24;  // of a coarse proxy: cells are nearly four voxels wide or more

/// A triangulation with V vertices and Euler number chi has 4 V - 3 chi after one split.
int64_t coarser_count(int64_t count, const SheetTopology& topology) {
  const int64_t chi = 2 * (topology.components - topology.genus);
  return (count + 3 * chi) / 4;
}

/// Counts from coarse to fine, as long as a level has seeds enough, and until one has few.
std::vector<int64_t> level_counts(int64_t finest, const SheetTopology& sheet) {
  const int64_t fewest = std::max(kFewestSeeds, kFewestPerPart * sheet.components);
  std::vector<int64_t> counts{finest};
  while (counts.size() < 2 || counts.back() > kMostSeedsOfCoarsest) {
    const int64_t coarser = coarser_count(counts.back(), sheet);
    if (coarser < fewest || coarser >= counts.back()) break;
    counts.push_back(coarser);
  }
  std::reverse(counts.begin(), counts.end());
  return counts;
}

/// How long levels take beside one another. The finest one makes fewer passes, and is improved later.
std::vector<double> weights_of_levels(const std::vector<int64_t>& counts) {
  constexpr double kCoarse = 2;
  std::vector<double> weights(counts.begin(), counts.end());
  for (size_t level = 0; level + 1 < weights.size(); ++level) weights[level] *= kCoarse;
  return weights;
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
  CoarseProxies(const PreparedSurface& prepared, const std::vector<int64_t>& counts, Context& context)
      : finest_(prepared.sheet) {
    halvings_.assign(counts.size(), 0);
    const SiteSet* sites = &solid_voxels_of(prepared);
    SiteSet of_coarsest;  // proxy so far
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
        of_coarsest = std::move(coarser);
        sites = &of_coarsest;
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
  /// Frees the proxies that only coarser levels relax on: the finest level takes most memory, and needs none.
  void drop_before(size_t level) { proxies_.erase(proxies_.begin() + halvings_[level], proxies_.end()); }

 private:
  /// Whether near parts of the surface are one in the coarse proxy, or join in places by many handles.
  bool have_merged(const SheetTopology& proxy, double cells) const {
    const auto handles = double(std::abs(proxy.genus - finest_.topology.genus));
    return proxy.components != finest_.topology.components || handles * kFewestSeedsPerHandle > cells;
  }

  const Sheet& finest_;
  std::vector<Sheet> proxies_;
  std::vector<int> halvings_;
};

}  // namespace

std::optional<SeededMesh> relax_level(const SurfaceMesh& surface, const CoarseLevel& level, SeedSet seeds,
                                      Context& context) {
  const int64_t requested = seeds.size();
  const bool has_mesh_passes = surface.lengths.at.empty();
  RelaxOptions relax = level.relax;
  relax.max_passes = has_mesh_passes ? kCoarsePasses : kCoarsePassesAlone;
  if (!level.tolerance_requested) relax.tolerance_ppb = kCoarseTolerancePpb;
  seeds = relax_on_sheet(surface, std::move(seeds), relax, context).seeds;
  Triangulation dual = triangulate_dual(surface, std::move(seeds), {}, context);
  if (dual.report.failed_cells > 0 || dual.seeds.size() - requested > requested * kMostRepairPerMille / 1000) return {};
  SeededMesh mesh = collapse_edges(surface, std::move(dual), {requested}, context);
  OptimizeOptions optimize;
  optimize.smoothing_steps = kCoarseSmoothingSteps;
  optimize.for_seeds = true;
  if (has_mesh_passes) optimize.mesh_passes = level.has_random_seeds ? kAnnealingPasses : kCoarseMeshPasses;
  if (has_mesh_passes && level.has_random_seeds) optimize.noise_edges = kAnnealingNoiseEdges;
  return optimize_mesh(surface, std::move(mesh), optimize, context);
}

RelaxOptions for_finest_level(RelaxOptions relax, bool tolerance_requested, int32_t usual_tolerance_ppb) {
  relax.max_passes = std::min(relax.max_passes, kFinestPasses);
  if (!tolerance_requested) relax.tolerance_ppb = usual_tolerance_ppb;
  return relax;
}
int32_t finest_tolerance_ppb(const SurfaceMesh& sheet) {
  return sheet.lengths.at.empty() ? kFinestTolerancePpb : kFinestTolerancePpbOfLengths;
}

RelaxedSeeds relax_by_levels(const PreparedSurface& prepared, const LevelOptions& options, Context& context,
                             const std::function<bool()>& is_in_vain) {
  require_seed_count(prepared.sheet, options.seeds.count);
  std::vector<int64_t> counts = level_counts(options.seeds.count, prepared.sheet.topology);
  CoarseProxies proxies(prepared, counts, context);
  for (size_t level = counts.size() - 1; level-- > 0;)  // coarse proxies may lack handles, or have more
    counts[level] = coarser_count(counts[level + 1], proxies.sheet(level).topology);
  StageParts parts(context, weights_of_levels(counts));
  SeedSet seeds;
  for (size_t level = 0; level + 1 < counts.size(); ++level) {
    if (is_in_vain()) return {};
    const StageShare part = parts.next();
    const Sheet& sheet = proxies.sheet(level);
    const bool has_random_seeds = seeds.size() == 0;
    if (has_random_seeds) seeds = place_seeds(sheet, {counts[level], options.seeds.seed}, context);
    const CoarseLevel coarse{options.relax, options.tolerance_requested, has_random_seeds};
    const std::optional<SeededMesh> relaxed = relax_level(sheet, coarse, std::move(seeds), context);
    seeds = {};
    if (relaxed) seeds = subdivide_seeds(sheet, relaxed->mesh, relaxed->seeds, counts[level + 1], context);
    const int halvings = proxies.halvings(level) - proxies.halvings(level + 1);
    proxies.drop_before(level + 1);
    if (relaxed && halvings > 0) seeds = attach_to_sheet(proxies.sheet(level + 1), std::move(seeds), halvings, context);
  }
  if (is_in_vain()) return {};
  RelaxOptions finest = options.relax;
  if (seeds.size() > 0)
    finest = for_finest_level(finest, options.tolerance_requested, finest_tolerance_ppb(prepared.sheet));
  else
    seeds = place_seeds(prepared.sheet, options.seeds, context);
  const StageShare part = parts.next();
  return relax_on_sheet(prepared.sheet, std::move(seeds), finest, context);
}

}  // namespace isoshell
