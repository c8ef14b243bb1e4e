// relax_in_patches (see patches.h).
#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/stage_share.h"
#include "features/cutting/coarser_surface.h"
#include "features/cutting/curve_seeds.h"
#include "features/cutting/cut_piece.h"
#include "features/cutting/free_seeds.h"
#include "pipeline/grid/attempt.h"
#include "pipeline/patches/patches.h"
#include "pipeline/patches/warm_patches.h"
#include "pipeline/sheet/hierarchy.h"

namespace isoshell {
namespace {

constexpr int32_t kFinestTolerancePpb = 100000;  ///< of patches: their fixed seeds keep them from settling soon
constexpr int32_t kLastPasses = 10;              ///< of the finest level, on the surface itself after a coarser one
constexpr int kMostLevels = 3;
constexpr int64_t kFewPerSeed = 13;  ///< vertices; coarser surfaces have 11 to 17

RelaxOptions for_finest_patches(const PatchOptions& options) {
  return for_finest_level(options.relax, options.tolerance_requested, kFinestTolerancePpb);
}

/// The levels of seeds, of which the first is the finest, and the surfaces with fewer triangles that they relax on.
class PatchLevels {
 public:
  PatchLevels(const CutSurface& cut, const PatchOptions& options, Context& context)
      : cut_(cut), free_seeds_(cut), options_(options), context_(context) {
    for (int level = 0; level < kMostLevels; ++level) {
      const SeedSet fixed = seeds_on_curves(cut, level);
      FreeSeeds::Counts free =
          level == 0 ? free_seeds_.counts(fixed, options.seeds.count) : free_seeds_.coarser(fixed, counts_.back());
      const int64_t fewest = std::max(kFewestSeeds, kFewestPerPart * free_seeds_.closed_parts(fixed));
      if (level > 0 && std::accumulate(free.begin(), free.end(), fixed.size()) < fewest) break;
      counts_.push_back(std::move(free));
    }
    const bool is_coarse = cut.surface.vertex_count() <= kFewPerSeed * options.seeds.count;
    const auto add_surfaces = [&]() -> std::string {
      if (!is_coarse) finest_ = coarser_surface(cut, counts_[0], 0, context);
      while (coarser_.size() + 1 < counts_.size())
        coarser_.push_back(coarser_surface(surface(coarser_.size()), counts_[coarser_.size() + 1], 1, context));
      return "";
    };
    failure_reason(add_surfaces);  // the levels that there is no surface for are left out
  }

  RelaxedSeeds relax() {
    StageParts parts(context_, weights_of_levels());
    for (size_t level = coarser_.size(); level > 0; --level) {
      const StageShare part = parts.next();
      relax_coarse(level);
    }
    if (finest_) {
      const StageShare part = parts.next();
      relax_finest();
    }
    const StageShare part = parts.next();
    RelaxOptions last = made_ ? for_finest_patches(options_) : options_.relax;
    if (finest_ && !options_.tolerance_requested) last.max_passes = std::min(last.max_passes, kLastPasses);
    return relax_on_sheet(cut_.surface, seeds_on(cut_, free_seeds_, 0, 0), last, context_);
  }

 private:
  /// How long levels take beside one another, in the order in which they are relaxed.
  std::vector<double> weights_of_levels() const {
    std::vector<double> weights;
    for (size_t level = coarser_.size(); level > 0; --level) weights.push_back(2 * std::pow(.25, level));
    if (finest_) weights.push_back(1);
    weights.push_back(finest_ ? .25 : 2);
    return weights;
  }

  const CutSurface& surface(size_t level) const {
    return level > 0 ? coarser_[level - 1].cut : finest_ ? finest_->cut : cut_;
  }
  /// The seeds of a level, on the surface of one that is so much finer.
  SeedSet seeds_on(const CutSurface& surface, const FreeSeeds& free_seeds, size_t level, int finer) const {
    SeedSet fixed = seeds_on_curves(surface, finer);
    return made_ ? free_seeds.add_finer(std::move(fixed), counts_[level], *made_, options_.seeds.seed)
                 : free_seeds.add(std::move(fixed), counts_[level], options_.seeds.seed);
  }
  std::optional<SeededMesh> relaxed_on(const CutSurface& surface, size_t level, int finer) const {
    const CoarseLevel coarse{options_.relax, options_.tolerance_requested, !made_};
    SeedSet seeds = seeds_on(surface, FreeSeeds(surface), level, finer);
    std::optional<SeededMesh> made = relax_level(surface.surface, coarse, std::move(seeds), context_);
    if (made) bring_to_host(*made);
    return made;
  }

  /// On its own surface; on the finer one where that is too coarse for it.
  void relax_coarse(size_t level) {
    std::optional<SeededMesh> made = relaxed_on(surface(level), level, 0);
    const bool is_done = made.has_value();
    if (is_done) made_ = std::move(made);
    if (made_) bring_to_finer(coarser_[level - 1], *made_);
    if (!is_done) made_ = relaxed_on(surface(level - 1), level, 1);
  }
  void relax_finest() {
    const CutSurface& on = finest_->cut;
    const RelaxOptions relax = made_ ? for_finest_patches(options_) : options_.relax;
    RelaxedSeeds relaxed = relax_on_sheet(on.surface, seeds_on(on, FreeSeeds(on), 0, 0), relax, context_);
    made_ = SeededMesh{{}, std::move(relaxed.seeds)};
    bring_to_host(*made_);
    bring_to_finer(*finest_, *made_);
  }

  const CutSurface& cut_;
  const FreeSeeds free_seeds_;
  const PatchOptions& options_;
  Context& context_;
  std::vector<FreeSeeds::Counts> counts_;  ///< of free seeds
  std::optional<CoarserSurface> finest_;   ///< none where the surface itself has few, or it fails
  std::vector<CoarserSurface> coarser_;    ///< of levels from 1 on, each of the one before it; fewer where one fails
  std::optional<SeededMesh> made_;         ///< by the level before, on the surface of the next one
};

}  // namespace

RelaxedSeeds relax_in_patches(const CutSurface& cut, const PatchOptions& options, Context& context) {
  if (options.previous) return relax_patches_from_previous(cut, options, context);
  return PatchLevels(cut, options, context).relax();
}

}  // namespace isoshell
