// See patch_rounds.h.
#include "pipeline/patch_rounds.h"

#include <algorithm>

#include "core/copy_product.h"
#include "core/watched.h"
#include "features/change_paths.h"
#include "features/curve_seeds.h"
#include "features/cut_fine_mesh.h"
#include "features/cut_piece.h"
#include "features/free_seeds.h"
#include "isoshell/to_host.h"
#include "measure/crossing_corners.h"
#include "measure/crossings.h"
#include "pipeline/dual_of_seeds.h"
#include "pipeline/flat_patches.h"
#include "pipeline/patch_defects.h"
#include "pipeline/resolve_intersections.h"
#include "pipeline/timed.h"

namespace isoshell {
namespace {

constexpr int kMostRounds = 10;
constexpr size_t kMostWork = 2;  ///< of all rounds after the first one, over that of the whole surface

SeededMesh fetched(const SeededMesh& made) {
  SeededMesh out;
  out.mesh = to_host(made.mesh);
  out.seeds = to_host(made.seeds);
  return out;
}

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
  std::vector<PointQ8> places;
  int64_t failed = 0, crossing = 0;  ///< vertices around which triangles are no surface, pairs that intersect

  explicit Wrong(const CutSurface& cut) : patch(none_of(cut)) {}
  bool is_nowhere() const { return !any(patch); }
  std::string said() const {
    if (crossing > 0) return std::to_string(crossing) + " pairs of triangles would intersect";
    return std::to_string(failed) + " cells beside them are no disks";
  }
};

class PatchRounds {
 public:
  PatchRounds(const Prepared& p, const PatchOptions& options, RemeshReport& report, Context& context)
      : p_(p), options_(options), report_(report), context_(context) {
    if (p.surface.topology.closed) return;
    const OnHost<LatticeSurface> input(p.surface);  // a result that is open may intersect itself where the input does
    input_crossings_ = find_crossings(input->points.view(), input->triangles.view(), context);
  }

  std::string run(std::shared_ptr<const CutSurface>& cut, SeededMesh& made) {
    const int64_t vertices = vertices_of(made.seeds);
    Wrong failed = mesh_patches(*cut, made);
    for (int round = 0;; ++round) {
      Wrong wrong = find_wrong(*cut, made, failed);
      if (!wrong.is_nowhere() && any(triangulate_flat(*cut, wrong.patch, made))) wrong = find_wrong(*cut, made, failed);
      if (wrong.is_nowhere()) return "";
      check_cancel(context_, "features");
      if (round == kMostRounds || work_ > kMostWork * cut->fine->triangles.size()) return wrong.said();
      std::optional<Paths> change = change_where(wrong, *cut, round);
      if (!change) return wrong.said();
      failed = make_again(cut, made, wrong, std::move(*change), vertices);
    }
  }

 private:
  static int64_t vertices_of(const SeedSet& seeds) {
    return count_places(OnHost(seeds)->fixed) + seeds.size() - seeds.fixed.count;
  }

  /// Runs work on the mesh of some patches alone; the mesh of the others stays, or goes.
  template <class Work>
  void on_patches(const CutSurface& cut, const PerPatch& chosen, bool keeps_others, SeededMesh& made, Work work) {
    if (all(chosen)) return work(cut, made);
    const SeededMesh whole = fetched(made);
    const PerPatch others = keeps_others ? inverse(chosen) : none_of(cut);
    const std::vector<uint32_t> kept = vertices_after(cut, cut, others);
    if (!any(chosen)) {
      made = gather_patches(cut, {{whole, kept}});
      return;
    }
    const CutPiece piece = piece_of(cut, chosen, context_);
    SeededMesh part = gather_patches(piece.cut, {{whole, in_piece(piece, cut)}});
    work(piece.cut, part);
    part = fetched(part);
    made = gather_patches(cut, {{whole, kept}, {part, piece.in_whole}});
  }

  /// Dual and optimisation of relaxed seeds. Result: the patches that fail, which then have no triangles.
  Wrong mesh_patches(const CutSurface& cut, SeededMesh& made) {
    make_dual_of_seeds(cut.surface, {made.seeds.size()}, made, report_, context_);
    Wrong failed(cut);
    if (report_.dual.failed_cells > 0) {
      made = fetched(made);
      add_defects(cut, made, find_patch_defects(made), failed);
      const PerPatch flat = triangulate_flat(cut, failed.patch, made);
      for (size_t patch = 0; patch < flat.size(); ++patch) failed.patch[patch] &= !flat[patch];
      if (failed.is_nowhere()) failed = Wrong(cut);
    }
    on_patches(cut, inverse(failed.patch), false, made, [&](const CutSurface& part, SeededMesh& mesh) {
      OptimizedMesh optimized = timed(report_, "post", context_, [&] {
        return optimize_mesh(part.surface, std::move(mesh), options_.optimize, context_);
      });
      report_.post = optimized.report;
      mesh = std::move(optimized);
    });
    untangle(cut, made);
    return failed;
  }

  static void add_defects(const CutSurface& cut, const SeededMesh& made, const std::vector<uint32_t>& vertices,
                          Wrong& wrong) {
    for (const uint32_t v : vertices) {
      ++wrong.failed;
      wrong.patch[cut.surface.patch[made.seeds.home[v]]] = 1;
      wrong.places.push_back(made.mesh.position[v]);
    }
  }

  /// The pairs of triangles that intersect where the result must not. Notes how many there are in all.
  std::vector<std::array<uint32_t, 2>> crossing(const SeededMesh& made) const {
    auto pairs = crossing_pairs(made.mesh.position.view(), made.mesh.triangles.view(), made.seeds.fixed.joined.view(),
                                context_.cancel);
    report_.post.self_intersections = int64_t(pairs.size());
    if (pairs.empty() || input_crossings_.empty()) return pairs;
    const auto reach = int32_t(p_.cut->longest_edge_q8);
    const auto is_inputs = [&](const std::array<uint32_t, 2>& pair) {
      return count_apart({common_box(made.mesh.position.view(), made.mesh.triangles.view(), pair)}, input_crossings_,
                         reach) == 0;
    };
    pairs.erase(std::remove_if(pairs.begin(), pairs.end(), is_inputs), pairs.end());
    return pairs;
  }

  void untangle(const CutSurface& cut, SeededMesh& made) {
    if (report_.post.self_intersections == 0) return;
    made = fetched(made);
    const auto pairs = crossing(made);
    Wrong wrong(cut);
    add_crossing(cut, made, pairs, wrong);
    if (pairs.empty()) return;
    timed(report_, "untangle", context_, [&] {
      on_patches(cut, wrong.patch, true, made, [&](const CutSurface& part, SeededMesh& mesh) {
        RemeshReport here;
        here.post.self_intersections = int64_t(pairs.size());
        resolve_intersections(part.surface, options_.optimize, mesh, here, context_);
        report_.seeds_against_intersections += here.seeds_against_intersections;
      });
    });
  }

  static void add_crossing(const CutSurface& cut, const SeededMesh& made,
                           const std::vector<std::array<uint32_t, 2>>& pairs, Wrong& wrong) {
    wrong.crossing = int64_t(pairs.size());
    for (const auto& pair : pairs)
      for (const uint32_t t : pair) {
        const TriangleIndices i = made.mesh.triangles[t];
        wrong.patch[cut.surface.patch[made.seeds.home[i.a]]] = 1;
        for (const uint32_t v : {i.a, i.b, i.c}) wrong.places.push_back(made.mesh.position[v]);
      }
  }

  /// In the whole mesh, beside the patches that have failed.
  Wrong find_wrong(const CutSurface& cut, SeededMesh& made, const Wrong& failed) {
    made = fetched(made);
    Wrong wrong = failed;
    std::vector<uint32_t> defects = find_patch_defects(made);
    const auto is_known = [&](uint32_t v) { return failed.patch[cut.surface.patch[made.seeds.home[v]]]; };
    defects.erase(std::remove_if(defects.begin(), defects.end(), is_known), defects.end());
    add_defects(cut, made, defects, wrong);
    const auto pairs = crossing(made);
    add_crossing(cut, made, pairs, wrong);
    sort_places(wrong.places);
    return wrong;
  }

  /// Shorter segments are tried first.
  std::optional<Paths> change_where(const Wrong& wrong, const CutSurface& cut, int round) const {
    if (round == 0 && wrong.failed == 0)
      if (auto shorter = halve_segments(*cut.fine, wrong.places, cut.longest_edge_q8)) return shorter;
    return drop_creases(*cut.fine, wrong.places);
  }

  std::shared_ptr<const CutSurface> cut_again(const CutSurface& before, Paths paths) const {
    for (;;) {
      auto fine = std::make_shared<FineMesh>(*before.fine);
      fine->paths = std::move(paths);
      auto after = std::make_shared<CutSurface>(cut_fine_mesh(std::move(fine), before.frame, context_));
      after->is_asked = before.is_asked;
      after->seeds = before.seeds;
      after->source = before.source;
      std::optional<Paths> fewer = mend_tight_borders(*after);
      if (!fewer) return after;
      paths = std::move(*fewer);
    }
  }

  /// Along changed paths, with new patches beside these and in place of those that are wrong. Result: those that fail.
  Wrong make_again(std::shared_ptr<const CutSurface>& cut, SeededMesh& made, const Wrong& wrong, Paths paths,
                   int64_t vertices) {
    const std::shared_ptr<const CutSurface> before = cut;
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
    options.seeds.count = count_for(piece.cut, vertices - vertices_of(kept.seeds));
    SeededMesh part = gather_patches(
        piece.cut, {{made, through(vertices_after(*before, *next, all_of(*before)), in_piece(piece, *next))}});
    part.seeds = timed(report_, "relax", context_,
                       [&] { return relax_in_patches_again(piece.cut, part, options, context_).seeds; });
    const Wrong failed_here = mesh_patches(piece.cut, part);
    part = fetched(part);
    made = gather_patches(*next, {{kept, vertices_after(*next, *next, inverse(comes))}, {part, piece.in_whole}});
    Wrong failed(*next);
    failed.places = failed_here.places;
    failed.failed = failed_here.failed;
    for (size_t v = 0; v < piece.in_whole.size(); ++v)
      if (failed_here.patch[piece.cut.surface.patch[v]]) failed.patch[next->surface.patch[piece.in_whole[v]]] = 1;
    cut = next;
    return failed;
  }

  /// Vertices of a piece that has so many free ones, or as few as it takes.
  static int64_t count_for(const CutSurface& piece, int64_t free_vertices) {
    const SeedSet fixed = seeds_on_curves(piece, 0);
    return std::max(count_places(fixed.fixed) + free_vertices, FreeSeeds(piece).fewest(fixed));
  }

  const Prepared& p_;
  const PatchOptions& options_;
  RemeshReport& report_;
  Context& context_;
  std::vector<BoxOfPoints> input_crossings_;
  size_t work_ = 0;  ///< triangles of the fine mesh on which patches were made again
};

}  // namespace

std::string mesh_in_rounds(const Prepared& p, std::shared_ptr<const CutSurface>& cut, SeededMesh& made,
                           const PatchOptions& options, RemeshReport& report, Context& context) {
  return PatchRounds(p, options, report, context).run(cut, made);
}

}  // namespace isoshell
