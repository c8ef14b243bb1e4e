// See mesh_patches.h.
#include "pipeline/patches/mesh_patches.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "features/cutting/cut_piece.h"
#include "pipeline/defects/fan_patches.h"
#include "pipeline/defects/flat_patches.h"
#include "pipeline/defects/inverted_regions.h"
#include "pipeline/defects/part_twins.h"
#include "pipeline/defects/patch_defects.h"
#include "pipeline/grid/timed.h"
#include "pipeline/patches/new_crossings.h"
#include "pipeline/sheet/dual_of_seeds.h"
#include "pipeline/sheet/resolve_intersections.h"
#include "pipeline/sheet/warm_start.h"

namespace isoshell {
namespace {

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

/// What keeps a mesh from being the run's.
struct Wrong {
  PerPatch patch;
  std::vector<int64_t> defects;  ///< per patch, vertices around which triangles are no surface
  int64_t crossing = 0;          ///< pairs of triangles that intersect

  explicit Wrong(const CutSurface& cut) : patch(none_of(cut)), defects(patch.size(), 0) {}
  void forget(const PerPatch& repaired) {
    for (size_t p = 0; p < patch.size(); ++p)
      if (repaired[p]) patch[p] = 0, defects[p] = 0;
  }
  bool is_nowhere() const { return !any(patch); }
  std::string words() const {
    if (crossing > 0) return std::to_string(crossing) + " pairs of triangles would intersect";
    return std::to_string(std::accumulate(defects.begin(), defects.end(), int64_t(0))) +
           " cells beside them are no disks";
  }
};

class PatchMesher {
 public:
  PatchMesher(const PreparedSurface& p, const CutSurface& cut, const PatchOptions& options, RemeshReport& report,
              Context& context)
      : options_(options), report_(report), context_(context), crossings_(p, cut, context) {}

  WrongPatches mesh(const CutSurface& cut, SeededMesh& made) {
    report_.dual = {};
    report_.optimize = {};
    const Wrong wrong = triangulate_flat_where_wrong(cut, made, mesh_relaxed(cut, made));
    return {wrong.patch, wrong.is_nowhere() ? "" : wrong.words()};
  }

 private:
  OptimizeOptions optimize_options() const {
    return options_.previous ? for_warm_frame(options_.optimize) : options_.optimize;
  }

  /// Runs work on the mesh of some patches alone; the mesh of the others stays, or goes.
  template <class Work>
  void on_patches(const CutSurface& cut, const PerPatch& chosen, bool keeps_others, SeededMesh& made, Work work) {
    if (all(chosen)) return work(cut, made);
    bring_to_host(made);
    const SeededMesh whole = std::move(made);
    const PerPatch others = keeps_others ? inverse(chosen) : none_of(cut);
    const std::vector<uint32_t> kept = vertices_in(cut, others);
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
  Wrong mesh_relaxed(const CutSurface& cut, SeededMesh& made) {
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
    for (const uint32_t v : vertices) {
      const uint32_t patch = cut.surface.patch[made.seeds.home[v]];
      wrong.patch[patch] = 1;
      ++wrong.defects[patch];
    }
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
      for (const uint32_t t : pair) wrong.patch[cut.surface.patch[made.seeds.home[made.mesh.triangles[t].a]]] = 1;
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
  Wrong triangulate_flat_where_wrong(const CutSurface& cut, SeededMesh& made, Wrong failed) {
    const Wrong wrong = find_wrong(cut, made, failed);
    if (wrong.is_nowhere()) return wrong;
    failed.forget(triangulate_flat(cut, wrong.patch, made));
    if (!cut.regions) return find_wrong(cut, made, failed);
    const Wrong still = find_wrong(cut, made, failed);
    failed.forget(triangulate_as_fans(cut, still.patch, made));
    return find_wrong(cut, made, failed);
  }

  const PatchOptions& options_;
  RemeshReport& report_;
  Context& context_;
  NewCrossings crossings_;
};

}  // namespace

WrongPatches mesh_patches(const PreparedSurface& p, const CutSurface& cut, SeededMesh& made,
                          const PatchOptions& options, RemeshReport& report, Context& context) {
  return PatchMesher(p, cut, options, report, context).mesh(cut, made);
}

}  // namespace isoshell
