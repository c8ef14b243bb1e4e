// Algorithm 1 of the paper, readable as such: prepare (line 2, and 3 where the shell is wanted), relax (1 and 4 to 9),
// triangulate (11). Line 10, flood_shell, makes the Voronoi volume that is saved; the dual is taken on the sheet.
#include "isoshell/remesh.h"

#include <sstream>
#include <utility>

#include "core/copy_product.h"
#include "features/cutting/cut_surface.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/error.h"
#include "measure/crossing_corners.h"
#include "options/check_options.h"
#include "pipeline/grid/attempt.h"
#include "pipeline/grid/choose_grid.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/grid/thin_walls.h"
#include "pipeline/grid/timed.h"
#include "pipeline/patches/cut_curves.h"
#include "pipeline/patches/patches.h"
#include "pipeline/patches/sheet_when_needed.h"
#include "pipeline/sheet/dual_of_seeds.h"
#include "pipeline/sheet/flag_gaps.h"
#include "pipeline/sheet/merge_walls.h"
#include "pipeline/sheet/relax_meanwhile.h"
#include "pipeline/sheet/resolve_intersections.h"
#include "pipeline/sheet/warm_start.h"

namespace isoshell {
namespace {

PatchOptions patch_options(const Prepared& p, const RemeshOptions& options, const OptimizeOptions& optimize,
                           bool is_warm) {
  return {{p.cut->seeds, options.seed},
          relax_options(options),
          options.tolerance.has_value(),
          optimize,
          is_warm ? options.previous : nullptr};
}

/// On the patches of a cut surface, or on the sheet.
SeedSet relax_seeds(const Prepared& p, const RemeshOptions& asked, bool in_patches, RemeshReport& report,
                    Context& context) {
  const RemeshOptions options = checked(asked);
  const SeedOptions seed_options{in_patches ? p.cut->seeds : vertex_target(options, p), options.seed};
  const bool is_warm = report.coherence.began_warm = options.previous && p.previous;
  RelaxedSeeds relaxed;
  if (in_patches) {
    relaxed = timed(report, "relax", context,
                    [&] { return relax_in_patches(*p.cut, patch_options(p, options, {}, is_warm), context); });
  } else if (is_warm) {
    relaxed = timed(report, "relax", context, [&] { return relaxed_from_previous(p, options, context); });
  } else if (options.method == Method::sheet) {
    relaxed = timed(report, "relax", context, [&] { return relaxed_by_levels(p, options, context); });
  } else {
    SeedSet start =
        timed(report, "seeds", context, [&] { return place_seeds(p.sites, p.samples, seed_options, context); });
    relaxed = timed(report, "relax", context, [&] {
      return relax_in_shell(p.shell, p.sites, p.samples, std::move(start), relax_options(options), context);
    });
    relaxed.seeds = timed(report, "attach", context,
                          [&] { return attach_to_sheet(p.sheet, std::move(relaxed.seeds), 0, context); });
  }
  report.relax = std::move(relaxed.report);
  SeedSet seeds = std::move(relaxed.seeds);
  report.seeds = seeds.size();
  note_digest(options, report, context, "seeds", seeds);
  return seeds;
}

/// Dual, repair and the final mesh on the sheet.
void mesh_on_sheet(const Prepared& p, const RemeshOptions& asked, OptimizeOptions options, SeededMesh& made,
                   RemeshReport& report, Context& context) {
  report.post = {};
  report.post_done = false;
  const bool is_warm = report.coherence.began_warm;
  if (is_warm) options = for_warm_frame(options);
  const int64_t count = is_warm ? vertex_target(asked, p) : made.seeds.size();
  make_dual_of_seeds(p.sheet, {count, false, is_warm}, made, report, context);
  if (report.dual.failed_cells > 0) return;
  OptimizedMesh optimized =
      timed(report, "post", context, [&] { return optimize_mesh(p.sheet, std::move(made), options, context); });
  report.post = optimized.report;
  made = std::move(optimized);
  if (report.post.self_intersections > 0)
    timed(report, "untangle", context, [&] { resolve_intersections(p, options, is_warm, made, report, context); });
  report.post_done = true;
}

/// A mesh on a sheet, and how it came about. Of two attempts that is kept which has fewer flaws.
struct Attempt {
  SeededMesh made;
  RemeshReport report;

  /// Cells that are no disks, before pairs of triangles that intersect.
  std::pair<int64_t, int64_t> flaws() const { return {report.dual.failed_cells, report.post.self_intersections}; }
};

/// Gives the caller the seeds and the report of an attempt, whether a stage returned or threw: stages take seeds by
/// moving.
struct GiveBack {
  Attempt& from;
  SeedSet& seeds;
  RemeshReport& report;
  ~GiveBack() {
    seeds = std::move(from.made.seeds);
    report = std::move(from.report);
  }
};

/// From new seeds. Result: why there is none, because of room or memory; empty otherwise.
std::string try_on_sheet(const Prepared& p, const RemeshOptions& options, const OptimizeOptions& optimize,
                         Attempt& attempt, Context& context) {
  try {
    return reason_against([&]() -> std::string {
      attempt.made = {};
      attempt.made.seeds = relax_seeds(p, options, false, attempt.report, context);
      mesh_on_sheet(p, options, optimize, attempt.made, attempt.report, context);
      return "";
    });
  } catch (const Error& error) {
    if (error.code() != ErrorCode::out_of_memory) throw;
    return error.what();
  }
}

/// Puts another attempt on a sheet in the place of the one that there is, where it has fewer flaws. Its time counts
/// anyway.
bool keep_better(const Prepared& p, const RemeshOptions& options, const OptimizeOptions& optimize, Attempt& best,
                 Context& context) {
  Attempt other{{}, best.report};
  const bool is_made = try_on_sheet(p, options, optimize, other, context).empty();
  if (is_made && other.flaws() < best.flaws()) {
    best = std::move(other);
    return true;
  }
  best.report.times = std::move(other.report.times);
  return false;
}

/// Merges walls where triangles intersect, and makes the mesh anew, while that leaves fewer that do. Null where nothing
/// was merged.
std::unique_ptr<MergedWalls> merge_where_crossing(const Prepared& p, RemeshOptions asked,
                                                  const OptimizeOptions& optimize, Attempt& best, Context& context) {
  asked.method = Method::sheet;
  const RemeshOptions options = checked(asked);
  std::unique_ptr<MergedWalls> kept;
  std::vector<PointQ8> points;
  for (int merge = 0; merge < kMostMerges && best.report.post.self_intersections > 0; ++merge) {
    const std::vector<PointQ8> more = crossing_corners(*OnHost(best.made.mesh), {});
    points.insert(points.end(), more.begin(), more.end());
    sort_places(points);  // a mesh that stays has the same ones again
    auto merged = std::make_unique<MergedWalls>(
        timed(best.report, "merge", context, [&] { return merge_walls(p, points, merge, options, context); }));
    if (keep_better(merged->prepared, options, optimize, best, context)) kept = std::move(merged);
  }
  if (kept) report_merge(*kept, points, best.report);
  return kept;
}

/// A frame that cannot be meshed from the one before begins cold, where that gives a better mesh.
void begin_again_cold(const Prepared& p, RemeshOptions options, const OptimizeOptions& optimize, Attempt& best,
                      Context& context) {
  const auto [failed, crossing] = best.flaws();
  if (!best.report.coherence.began_warm || (failed == 0 && crossing == 0)) return;
  options.previous.reset();
  if (!keep_better(p, options, optimize, best, context)) return;
  best.report.coherence.why_cold =
      failed > 0 ? "cells of the carried vertices are no disks" : "triangles of the carried vertices intersect";
}

/// Numbers as in the frame before, where the mesh has not kept them, and how steady the frame is.
void follow_previous(const RemeshOptions& options, bool has_numbers, TriangleMesh& mesh, RemeshReport& report) {
  if (!options.previous) return;
  if (!has_numbers) number_as_before(*options.previous, mesh);
  measure_coherence(*options.previous, mesh, report.coherence);
}

/// Where the grid is too coarse for that, too, the error says why it is tried.
SeedSet relax_without_creases(const Prepared& p, const RemeshOptions& options, RemeshReport& report, Context& context) {
  try {
    return relax_seeds(p, options, false, report, context);
  } catch (const NoRoom& error) {
    throw NoRoom(error.stage(),
                 std::string(error.what()) + "; creases could not be kept either: " + report.features.given_up);
  }
}

/// What is not as it should be.
void warn_of_mesh(const Prepared& p, const SeededMesh& made, int64_t asked, RemeshReport& report) {
  if (report.dual.failed_cells > 0)
    report.warnings.push_back(
        std::to_string(report.dual.failed_cells) +
        " cells stay that are no disks: the result is not a closed 2-manifold; use a higher --resolution");
  if (made.seeds.size() != asked)
    report.warnings.push_back("the result has " + std::to_string(made.seeds.size()) + " vertices instead of " +
                              std::to_string(asked) + ": its topology needs them at this resolution");
  if (report.post.self_intersections == 0) return;
  const std::vector<PointQ8> corners = crossing_corners(*OnHost(made.mesh), {});
  const WorldPoint at = p.surface.frame.to_world(corners.empty() ? made.mesh.position[0] : corners.front());
  report.intersection_at = at;
  std::ostringstream text;
  text << report.post.self_intersections << " pairs of triangles intersect, near " << at.x << ' ' << at.y << ' ' << at.z
       << ": parts of the surface are nearer to one another than its edges are long; ask for more --vertices";
  report.warnings.push_back(text.str());
}

/// From relaxed seeds, with all that is tried where the mesh has flaws.
TriangleMesh triangulate_on_sheet(const Prepared& p, const RemeshOptions& options, const OptimizeOptions& optimize,
                                  Attempt& best, Context& context) {
  const int64_t asked = best.report.coherence.began_warm ? vertex_target(options, p) : best.made.seeds.size();
  mesh_on_sheet(p, options, optimize, best.made, best.report, context);
  begin_again_cold(p, options, optimize, best, context);
  const std::unique_ptr<MergedWalls> merged = merge_where_crossing(p, options, optimize, best, context);
  const Prepared& meshed = merged ? merged->prepared : p;
  warn_of_mesh(meshed, best.made, asked, best.report);
  measure_edges(meshed.sheet, best.made.seeds, best.made.mesh, best.report.sizing, context);
  TriangleMesh mesh = to_world(best.made.mesh, meshed.surface.frame);
  flag_gaps(meshed, OnHost(best.made.seeds)->home.view(), mesh, best.report.gaps);
  follow_previous(options, best.report.coherence.began_warm, mesh, best.report);
  note_digest(options, best.report, context, "mesh", mesh);
  return mesh;
}

}  // namespace

SeedSet relax(const Prepared& p, const RemeshOptions& options, RemeshReport& report, Context& context) {
  return relax_seeds(p, options, p.cut != nullptr, report, context);
}

TriangleMesh triangulate(const Prepared& p, SeedSet& seeds, const RemeshOptions& as_asked, RemeshReport& report,
                         Context& context) {
  const RemeshOptions options = checked(as_asked);
  OptimizeOptions optimize;
  optimize.fit = options.fit;
  optimize.uniform_area = options.uniform_area;
  Attempt best{{}, std::exchange(report, {})};
  const GiveBack give_back{best, seeds, report};
  best.made.seeds = std::move(seeds);
  SheetWhenNeeded sheet(p, options, context);
  if (p.cut && best.made.seeds.fixed.count > 0) {
    const PatchOptions in_patches = patch_options(p, options, optimize, best.report.coherence.began_warm);
    if (std::optional<TriangleMesh> mesh =
            triangulate_patches(p, sheet, best.made, options, in_patches, best.report, context)) {
      follow_previous(options, false, *mesh, best.report);
      note_digest(options, best.report, context, "mesh", *mesh);
      return std::move(*mesh);
    }
    best.report.post = {};
    if (is_on_own_triangles(p)) warn_of_topology(sheet.get(best.report), p.surface.topology, options, best.report);
    best.made.seeds = relax_without_creases(sheet.get(best.report), options, best.report, context);
  }
  return triangulate_on_sheet(sheet.get(best.report), options, optimize, best, context);
}

RemeshResult remesh(const TriangleSoup& soup, const RemeshOptions& asked, Context& context) {
  RemeshResult result;
  RemeshOptions options = asked;
  options.want_samples = false;
  Prepared prepared = prepare(soup, options, result.report, context);
  if (options.method == Method::sheet) prepared.samples = {};  // made the sheet, and are not read again
  SeedSet seeds = relax(prepared, options, result.report, context);
  result.mesh = triangulate(prepared, seeds, options, result.report, context);
  return result;
}

}  // namespace isoshell
