// See simplify_patches.h.
#include "pipeline/patches/simplify_patches.h"

#include <memory>
#include <string>
#include <utility>

#include "features/cutting/cut_piece.h"
#include "features/walls/coarsen_walls.h"
#include "features/walls/collapse_crossings.h"
#include "features/walls/open_mesh.h"
#include "pipeline/defects/inverted_regions.h"
#include "pipeline/defects/patch_defects.h"
#include "pipeline/grid/attempt.h"

namespace isoshell {
namespace {

struct Optimized {
  EditableMesh mesh;
  OptimizeReport report;
};

/// From where no triangles intersect: what would make some stays as it was. None of patches that are no manifold, or
/// that a stage has no room for.
std::optional<Optimized> optimized(const PatchMesh& mesh, const OptimizeOptions& options, Run& run) {
  OpenMesh open(mesh, mesh.lookup());
  SeededMesh made = open.take();
  if (!find_patch_defects(made).empty()) return {};
  OptimizeOptions careful = options;
  careful.keep_apart = true;
  OptimizedMesh out;
  const std::string why_not = failure_reason([&]() -> std::string {
    out = run.timed("post",
                    [&] { return optimize_mesh(mesh.lookup().cut().surface, std::move(made), careful, run.context); });
    return "";
  });
  if (!why_not.empty()) return {};
  bring_to_host(out);
  return Optimized{open.joined_again(out), out.report};
}

}  // namespace

bool JoinedCheck::is_valid(const JoinedPatches& joined, OptimizeReport& report) {
  const TrianglePairs pairs = crossings_.all(joined.mesh, {});
  report.self_intersections = int64_t(pairs.size());
  return crossings_.wrong_of(joined.mesh, pairs).empty() &&
         (!cut_.regions || find_inverted_regions(cut_, joined.mesh, joined.features.patch).empty());
}

std::optional<JoinedPatches> simplify_patches(WallMesh mesh, const PatchOptions& options, JoinedCheck& check,
                                              OptimizeReport& sum, Run& run) {
  const JoinOptions join = join_options(options);
  const std::shared_ptr<const CutLookup> lookup = mesh.shared_lookup();
  run.timed("coarsen", [&] {
    if (!check.crossings().may_be_old()) collapse_crossings(mesh, run.context);
    coarsen_walls(mesh, join.vertices, run.context);
  });
  PatchMesh made(lookup, std::move(mesh), join);
  OptimizeReport done;
  if (check.is_valid(made.joined(), done))  // otherwise triangles intersect before anything is optimised
    if (std::optional<Optimized> better = optimized(made, options.optimize, run)) {
      made = PatchMesh(lookup, std::move(better->mesh), join);
      done = better->report;
    }
  JoinedPatches joined = run.timed("angles", [&] { return widened_to_count(std::move(made), run.context); });
  if (!check.is_valid(joined, sum)) return {};
  sum.flips += done.flips;
  sum.undone_vertices += done.undone_vertices;
  return joined;
}

}  // namespace isoshell
