// See patch_rounds.h.
#include "pipeline/patches/patch_rounds.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/copy_product.h"
#include "core/watched.h"
#include "features/cutting/change_paths.h"
#include "features/cutting/curve_seeds.h"
#include "features/cutting/cut_fine_mesh.h"
#include "features/cutting/cut_piece.h"
#include "features/cutting/free_seeds.h"
#include "measure/crossing_corners.h"
#include "pipeline/defects/fan_patches.h"
#include "pipeline/defects/flat_patches.h"
#include "pipeline/defects/inverted_regions.h"
#include "pipeline/defects/part_twins.h"
#include "pipeline/defects/patch_defects.h"
#include "pipeline/grid/attempt.h"
#include "pipeline/grid/timed.h"
#include "pipeline/patches/cut_curves.h"
#include "pipeline/patches/new_crossings.h"
#include "pipeline/sheet/dual_of_seeds.h"
#include "pipeline/sheet/resolve_intersections.h"
#include "pipeline/sheet/warm_start.h"

namespace isoshell {
namespace {

constexpr int kMostRounds = 10;
constexpr size_t kMostWork = 2;      ///< of all rounds after the first one, over that of the whole surface
constexpr size_t kMostHelpless = 1;  ///< the same of rounds that did not help, where there is another way
constexpr int64_t kFewTriangles = 800;
constexpr int64_t kMostCrossing = 40;  ///< one pair of triangles in so many: where more intersect the surface does, too

using PerPatch = std::vector<char>;

PerPatch inverse(const PerPatch& flags) {
  PerPatch out(flags.size());
  std::transform(flags.begin(), flags.end(), out.begin(), [](char flag) { return !flag; });
  return out;
}
bool any(const PerPatch& flags) {
  return std::any_of(flags.begin(), flags.end(), [](char flag) { return flag; });
}
bool all(const PerPatch& flags) { return !any(inverse(flags)); }

PerPatch none_of(const CutSurface& cut) { return PerPatch(patch_count(cut), 0); }
PerPatch all_of(const CutSurface& cut) { return PerPatch(patch_count(cut), 1); }

/// Where vertices go that first go where `first` says, and from there where `second` says.
std::vector<uint32_t> through(std::vector<uint32_t> first, const std::vector<uint32_t>& second) {
  for (uint32_t& v : first) v = v == kNone ? kNone : second[v];
  return first;
}

/// What keeps a mesh from being the run's.
struct Wrong {
  PerPatch patch;
  std::vector<std::pair<uint32_t, PointQ8>> where;  ///< patches and places in them
  int64_t crossing = 0;  ///< pairs of triangles that intersect, whose corners are among these

  explicit Wrong(const CutSurface& cut) : patch(none_of(cut)) {}
  void add(uint32_t in_patch, PointQ8 place) {
    patch[in_patch] = 1;
    where.push_back({in_patch, place});
  }
  /// Patches that are right now.
  void forget(const PerPatch& repaired) {
    for (size_t p = 0; p < patch.size(); ++p) patch[p] &= !repaired[p];
    where.erase(std::remove_if(where.begin(), where.end(), [&](const auto& w) { return repaired[w.first]; }),
                where.end());
  }
  bool is_nowhere() const { return !any(patch); }
  /// Vertices around which triangles are no surface.
  int64_t failed() const { return int64_t(where.size()) - 6 * crossing; }
  std::vector<PointQ8> places() const {
    std::vector<PointQ8> out;
    for (const auto& [in_patch, place] : where) out.push_back(place);
    sort_points(out);
    return out;
  }
  std::string said() const {
    if (crossing > 0) return std::to_string(crossing) + " pairs of triangles would intersect";
    return std::to_string(failed()) + " cells beside them are no disks";
  }
};

class PatchRounds {
 public:
  PatchRounds(const PreparedSurface& p, const CutSurface& cut, const PatchOptions& options, RemeshReport& report,
              Context& context)
      : options_(options), report_(report), context_(context), crossings_(p, cut, context) {}

  WrongPatches once(const CutSurface& cut, SeededMesh& made) {
    const Wrong wrong = first(cut, made);
    return {wrong.patch, wrong.is_nowhere() ? "" : wrong.said()};
  }

  std::string run(std::shared_ptr<const CutSurface>& cut, SeededMesh& made) {
    Wrong wrong = first(*cut, made);
    if (!wrong.is_nowhere() && wrong.failed() == 0 && !is_hopeless(wrong)) halve_where(cut, made, wrong);
    for (int round = 0; !wrong.is_nowhere(); ++round) {
      if (options_.previous || is_hopeless(wrong) || is_helpless(*cut)) return wrong.said();
      if (round == kMostRounds || work_ > kMostWork * cut->fine->triangles.size()) return wrong.said();
      std::optional<Paths> fewer = drop_creases(*cut->fine, wrong.places());
      if (!fewer) return wrong.said();
      Again again = make_again(cut, made, wrong, std::move(*fewer));
      cut = again.cut;
      made = std::move(again.made);
      wrong = std::move(again.wrong);
    }
    return "";
  }

 private:
  Wrong first(const CutSurface& cut, SeededMesh& made) {
    report_.dual = {};
    report_.optimize = {};
    return left_of(cut, made, mesh_patches(cut, made));
  }

  OptimizeOptions optimize_options() const {
    return options_.previous ? for_warm_frame(options_.optimize) : options_.optimize;
  }

  /// What comes of other paths.
  struct Again {
    std::shared_ptr<const CutSurface> cut;
    SeededMesh made;
    Wrong wrong;
  };

  /// Runs work on the mesh of some patches alone; the mesh of the others stays, or goes.
  template <class Work>
  void on_patches(const CutSurface& cut, const PerPatch& chosen, bool keeps_others, SeededMesh& made, Work work) {
    if (all(chosen)) return work(cut, made);
    bring_to_host(made);
    const SeededMesh whole = std::move(made);
    const PerPatch others = keeps_others ? inverse(chosen) : none_of(cut);
    const std::vector<uint32_t> kept = vertices_after(cut, cut, others);
    if (!any(chosen)) {
      made = gather_patches(cut, {{whole, kept}});
      return;
    }
    const CutPiece piece = piece_of(cut, chosen, context_);
    SeededMesh part = gather_patches(piece.cut, {{whole, in_piece(piece, cut)}});
    work(piece.cut, part);
    bring_to_host(part);
    made = gather_patches(cut, {{whole, kept}, {part, piece.in_whole}});
  }

  /// Dual and optimisation of relaxed seeds. Result: the patches that fail, which then have no triangles.
  Wrong mesh_patches(const CutSurface& cut, SeededMesh& made) {
    Wrong failed(cut);
    const bool are_disks = make_dual(cut, made);
    if (cut.regions) {
      bring_to_host(made);
      part_twins(cut, made);
    }
    if (!are_disks || cut.regions) {
      bring_to_host(made);
      add_defects(cut, made, find_patch_defects(made), failed);
      const PerPatch is_flat = triangulate_flat(cut, failed.patch, made);
      failed.forget(is_flat);
      if (cut.regions && any(is_flat)) add_new_defects(cut, made, failed);
    }
    int64_t crossing = 0;
    on_patches(cut, inverse(failed.patch), false, made, [&](const CutSurface& part, SeededMesh& mesh) {
      OptimizedMesh optimized = timed(report_, "post", context_, [&] {
        return optimize_mesh(part.surface, std::move(mesh), optimize_options(), context_);
      });
      crossing = optimized.report.self_intersections;
      report_.optimize.flips += optimized.report.flips;
      report_.optimize.undone_vertices += optimized.report.undone_vertices;
      mesh = std::move(optimized);
    });
    if (crossing > 0) untangle(cut, made);
    return failed;
  }

  /// Of so many vertices the whole mesh has twice as many triangles.
  bool is_hopeless(const Wrong& wrong) const {
    return kMostCrossing * wrong.crossing > std::max(2 * options_.seeds.count, kFewTriangles);
  }

  /// Whether rounds took long and did not help, where there is another way: curves are laid on the sheet.
  bool is_helpless(const CutSurface& cut) const {
    return cut.source->input && helpless_work_ > kMostHelpless * cut.fine->triangles.size();
  }

  /// Result: whether all cells are disks.
  bool make_dual(const CutSurface& cut, SeededMesh& made) {
    RemeshReport here;
    make_dual_of_seeds(cut.surface, {made.seeds.size()}, made, here, context_);
    for (const StageTime& t : here.times) book_time(report_, t.stage.c_str(), t.ms);
    report_.dual.inserted_seeds += here.dual.inserted_seeds;
    report_.dual.relabelled_vertices += here.dual.relabelled_vertices;
    report_.dual.repair_rounds += here.dual.repair_rounds;
    return here.dual.failed_cells == 0;
  }

  static void add_defects(const CutSurface& cut, const SeededMesh& made, const std::vector<uint32_t>& vertices,
                          Wrong& wrong) {
    for (const uint32_t v : vertices) wrong.add(cut.surface.patch[made.seeds.home[v]], made.mesh.position[v]);
  }

  /// Beside the patches that are known to be wrong.
  static void add_new_defects(const CutSurface& cut, const SeededMesh& made, Wrong& wrong) {
    std::vector<uint32_t> defects = find_patch_defects(made);
    const auto is_known = [&](uint32_t v) { return wrong.patch[cut.surface.patch[made.seeds.home[v]]]; };
    defects.erase(std::remove_if(defects.begin(), defects.end(), is_known), defects.end());
    add_defects(cut, made, defects, wrong);
  }

  static std::vector<uint32_t> patches_of(const CutSurface& cut, const SeededMesh& made) {
    std::vector<uint32_t> patch;
    for (const TriangleIndices& t : made.mesh.triangles) patch.push_back(cut.surface.patch[made.seeds.home[t.a]]);
    return patch;
  }

  TrianglePairs all_crossing(const SeededMesh& made) const {
    return crossings_.all(made.mesh, made.seeds.fixed.joined.view());
  }

  void untangle(const CutSurface& cut, SeededMesh& made) {
    bring_to_host(made);
    Wrong wrong(cut);
    add_crossing(cut, made, crossings_.wrong_of(made.mesh, all_crossing(made)), wrong);
    if (wrong.is_nowhere() || is_hopeless(wrong)) return;
    timed(report_, "untangle", context_, [&] {
      on_patches(cut, wrong.patch, true, made, [&](const CutSurface& part, SeededMesh& mesh) {
        RemeshReport here;
        here.optimize.self_intersections = int64_t(all_crossing(mesh).size());
        resolve_intersections(part.surface, optimize_options(), mesh, here, context_);
        report_.seeds_against_intersections += here.seeds_against_intersections;
      });
    });
  }

  static void add_crossing(const CutSurface& cut, const SeededMesh& made, const TrianglePairs& pairs, Wrong& wrong) {
    wrong.crossing = int64_t(pairs.size());
    for (const auto& pair : pairs)
      for (const uint32_t t : pair) {
        const TriangleIndices i = made.mesh.triangles[t];
        for (const uint32_t v : {i.a, i.b, i.c})
          wrong.add(cut.surface.patch[made.seeds.home[i.a]], made.mesh.position[v]);
      }
  }

  /// In the whole mesh, beside the patches that have failed.
  Wrong find_wrong(const CutSurface& cut, SeededMesh& made, const Wrong& failed) {
    bring_to_host(made);
    Wrong wrong = failed;
    add_new_defects(cut, made, wrong);
    if (cut.regions) add_defects(cut, made, find_inverted_regions(cut, made.mesh, patches_of(cut, made)), wrong);
    const auto pairs = all_crossing(made);
    report_.optimize.self_intersections = int64_t(pairs.size());
    add_crossing(cut, made, crossings_.wrong_of(made.mesh, pairs), wrong);
    return wrong;
  }

  /// In the whole mesh, with flat patches of it triangulated where something is wrong.
  Wrong left_of(const CutSurface& cut, SeededMesh& made, Wrong failed) {
    const Wrong wrong = find_wrong(cut, made, failed);
    if (wrong.is_nowhere()) return wrong;
    failed.forget(triangulate_flat(cut, wrong.patch, made));
    if (!cut.regions) return find_wrong(cut, made, failed);
    const Wrong still = find_wrong(cut, made, failed);
    failed.forget(triangulate_as_fans(cut, still.patch, made));
    return find_wrong(cut, made, failed);
  }

  /// Tries shorter segments, which cost no crease, and keeps them where less is wrong then.
  void halve_where(std::shared_ptr<const CutSurface>& cut, SeededMesh& made, Wrong& wrong) {
    std::optional<Paths> halved = halve_segments(*cut->fine, wrong.places(), cut->longest_edge_q8);
    if (!halved) return;
    std::optional<Again> again;
    failure_reason([&]() -> std::string {  // there may be no room for the seeds of so many segments
      again = make_again(cut, made, wrong, std::move(*halved));
      return "";
    });
    if (!again || again->wrong.failed() > 0 || again->wrong.where.size() >= wrong.where.size()) return;
    cut = again->cut;
    made = std::move(again->made);
    wrong = std::move(again->wrong);
  }

  std::shared_ptr<const CutSurface> cut_again(const CutSurface& before, Paths paths) {
    for (;;) {
      auto fine = std::make_shared<FineMesh>(*before.fine);
      fine->paths = std::move(paths);
      auto after = std::make_shared<CutSurface>(cut_fine_mesh(std::move(fine), before.frame, context_));
      after->is_requested = before.is_requested;
      after->seeds = before.seeds;
      after->source = before.source;
      std::optional<Paths> fewer = drop_creases_at_tight_borders(*after);
      if (!fewer) return after;
      paths = std::move(*fewer);
    }
  }

  /// Along changed paths, with new patches beside these and in place of those that are wrong.
  Again make_again(const std::shared_ptr<const CutSurface>& before, const SeededMesh& made, const Wrong& wrong,
                   Paths paths) {
    const std::shared_ptr<const CutSurface> next =
        timed(report_, "features", context_, [&] { return cut_again(*before, std::move(paths)); });
    PerPatch goes = wrong.patch;
    const std::vector<char> changed = which_changed(before->fine->paths, next->fine->paths);
    for (size_t c = 0; c < changed.size(); ++c)
      if (changed[c])
        for (const uint32_t patch : before->curves[c].patches) goes[patch] = 1;
    PerPatch comes = none_of(*next);
    for (size_t c = 0; c < next->corner.size(); ++c)
      if (goes[before->surface.patch[before->corner[c]]]) comes[next->surface.patch[next->corner[c]]] = 1;
    const SeededMesh kept = gather_patches(*next, {{made, vertices_after(*before, *next, inverse(goes))}});
    const CutPiece piece = piece_of(*next, comes, context_);
    work_ += piece.cut.fine->triangles.size();
    PatchOptions options = options_;
    options.seeds.count = count_for(piece.cut, free_of(*next, comes, options_.seeds.count));
    SeededMesh part = gather_patches(
        piece.cut, {{made, through(vertices_after(*before, *next, all_of(*before)), in_piece(piece, *next))}});
    part.seeds = timed(report_, "relax", context_,
                       [&] { return relax_in_patches_again(piece.cut, part, options, context_).seeds; });
    const Wrong failed_here = mesh_patches(piece.cut, part);
    bring_to_host(part);
    SeededMesh whole =
        gather_patches(*next, {{kept, vertices_after(*next, *next, inverse(comes))}, {part, piece.in_whole}});
    std::vector<uint32_t> patch_in_whole(patch_count(piece.cut));
    for (size_t v = 0; v < piece.in_whole.size(); ++v)
      patch_in_whole[piece.cut.surface.patch[v]] = next->surface.patch[piece.in_whole[v]];
    Wrong failed(*next);
    for (const auto& [patch, place] : failed_here.where) failed.add(patch_in_whole[patch], place);
    Wrong left = left_of(*next, whole, std::move(failed));
    const bool has_helped = left.where.size() < wrong.where.size();
    helpless_work_ = has_helped ? 0 : helpless_work_ + piece.cut.fine->triangles.size();
    return {next, std::move(whole), std::move(left)};
  }

  /// How many free seeds some patches have where the whole surface has so many vertices.
  static int64_t free_of(const CutSurface& cut, const PerPatch& chosen, int64_t vertices) {
    const FreeSeeds free_seeds(cut);
    const SeedSet fixed = seeds_on_curves(cut, 0);
    const FreeSeeds::Counts counts = free_seeds.counts(fixed, std::max(vertices, free_seeds.fewest(fixed)));
    int64_t sum = 0;
    for (size_t p = 0; p < chosen.size(); ++p) sum += chosen[p] ? counts[p] : 0;
    return sum;
  }

  /// Vertices of a piece that has so many free ones, or as few as it takes.
  static int64_t count_for(const CutSurface& piece, int64_t free_vertices) {
    const SeedSet fixed = seeds_on_curves(piece, 0);
    return std::max(count_places(fixed.fixed) + free_vertices, FreeSeeds(piece).fewest(fixed));
  }

  const PatchOptions& options_;
  RemeshReport& report_;
  Context& context_;
  NewCrossings crossings_;
  size_t work_ = 0;           ///< triangles of the fine mesh on which patches were made again
  size_t helpless_work_ = 0;  ///< of these the last ones, after which no less was wrong
};

}  // namespace

WrongPatches mesh_once(const PreparedSurface& p, const CutSurface& cut, SeededMesh& made, const PatchOptions& options,
                       RemeshReport& report, Context& context) {
  return PatchRounds(p, cut, options, report, context).once(cut, made);
}

std::string mesh_in_rounds(const PreparedSurface& p, std::shared_ptr<const CutSurface>& cut, SeededMesh& made,
                           const PatchOptions& options, RemeshReport& report, Context& context) {
  return PatchRounds(p, *cut, options, report, context).run(cut, made);
}

}  // namespace isoshell
