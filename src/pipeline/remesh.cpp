// Algorithm 1 of the paper, readable as such: prepare (line 2, and 3 where the shell is wanted), relax (1 and 4 to 9),
// triangulate (11). Line 10, flood_shell, makes the Voronoi volume that is saved; the dual is taken on the sheet.
#include "isoshell/remesh.h"

#include <utility>

#include "core/copy_product.h"
#include "features/cutting/cut_surface.h"
#include "geometry/given_surface.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"
#include "measure/crossing_corners.h"
#include "pipeline/grid/attempt.h"
#include "pipeline/grid/prepared_surface.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/grid/timed.h"
#include "pipeline/patches/patches.h"
#include "pipeline/patches/sheet_when_needed.h"
#include "pipeline/regions/mesh_of_regions.h"
#include "pipeline/regions/region_walls.h"
#include "pipeline/sheet/dual_of_seeds.h"
#include "pipeline/sheet/flag_gaps.h"
#include "pipeline/sheet/merge_walls.h"
#include "pipeline/sheet/relax_meanwhile.h"
#include "pipeline/sheet/resolve_intersections.h"
#include "pipeline/sheet/warm_start.h"

namespace isoshell {
namespace {

PatchOptions patch_options(const PreparedSurface& p, bool is_warm) {
  return {{p.cut->seeds, p.options.seed},
          relax_options(p.options),
          p.options.tolerance.has_value(),
          optimize_options(p.options),
          is_warm ? p.previous : nullptr};
}

/// Where a mesh goes on from: the vertices of the frame before, if the run has one, or new seeds.
enum class Begin { as_prepared, cold };

RelaxedSeeds relaxed_in_shell(const PreparedSurface& p, RemeshReport& report, Context& context) {
  const SeedOptions seeds{p.target.vertices, p.options.seed};
  SeedSet start = timed(report, "seeds", context, [&] { return place_seeds(p.sites, p.samples, seeds, context); });
  RelaxedSeeds relaxed = timed(report, "relax", context, [&] {
    return relax_in_shell(p.shell, p.sites, p.samples, std::move(start), relax_options(p.options), context);
  });
  relaxed.seeds =
      timed(report, "attach", context, [&] { return attach_to_sheet(p.sheet, std::move(relaxed.seeds), 0, context); });
  return relaxed;
}

/// On the patches of a cut surface, or on the sheet. None where a mesh is to be made without.
SeedSet relax_seeds(const PreparedSurface& p, Begin begin, bool in_patches, RemeshReport& report, Context& context) {
  if (p.walls && p.walls->are_too_near) return {};
  const bool is_warm = report.coherence.began_warm = begin == Begin::as_prepared && p.previous;
  RelaxedSeeds relaxed;
  if (!in_patches && !is_warm && p.options.method == Method::shell)
    relaxed = relaxed_in_shell(p, report, context);
  else
    relaxed = timed(report, "relax", context, [&] {
      if (in_patches) return relax_in_patches(*p.cut, patch_options(p, is_warm), context);
      return is_warm ? relaxed_from_previous(p, context) : relaxed_by_levels(p, context);
    });
  report.relax = std::move(relaxed.report);
  report.seeds = relaxed.seeds.size();
  note_digest(p.options, report, context, "seeds", relaxed.seeds);
  return std::move(relaxed.seeds);
}

/// Dual, repair and the final mesh on the sheet.
void mesh_on_sheet(const PreparedSurface& p, SeededMesh& made, RemeshReport& report, Context& context) {
  report.optimize = {};
  report.is_optimized = false;
  const bool is_warm = report.coherence.began_warm;
  const OptimizeOptions options = is_warm ? for_warm_frame(optimize_options(p.options)) : optimize_options(p.options);
  const int64_t count = is_warm ? p.target.vertices : made.seeds.size();
  make_dual_of_seeds(p.sheet, {count, false, is_warm}, made, report, context);
  if (report.dual.failed_cells > 0) return;
  OptimizedMesh optimized =
      timed(report, "post", context, [&] { return optimize_mesh(p.sheet, std::move(made), options, context); });
  report.optimize = optimized.report;
  made = std::move(optimized);
  if (report.optimize.self_intersections > 0)
    timed(report, "untangle", context, [&] { resolve_intersections(p, options, is_warm, made, report, context); });
  report.is_optimized = true;
}

/// A mesh on a sheet, and how it came about. Of two attempts that is kept which has fewer flaws.
struct Attempt {
  SeededMesh made;
  RemeshReport report;

  /// Cells that are no disks, before pairs of triangles that intersect.
  std::pair<int64_t, int64_t> flaws() const { return {report.dual.failed_cells, report.optimize.self_intersections}; }
};

/// From new seeds. Result: why there is none, because of room or memory; empty otherwise.
std::string try_on_sheet(const PreparedSurface& p, Attempt& attempt, Context& context) {
  try {
    return failure_reason([&]() -> std::string {
      attempt.made = {};
      attempt.made.seeds = relax_seeds(p, Begin::cold, false, attempt.report, context);
      mesh_on_sheet(p, attempt.made, attempt.report, context);
      return "";
    });
  } catch (const Error& error) {
    if (error.code() != ErrorCode::out_of_memory) throw;
    return error.what();
  }
}

/// Puts another attempt on a sheet in the place of the one that there is, where it has fewer flaws. Its time counts
/// anyway.
bool keep_better(const PreparedSurface& p, Attempt& best, Context& context) {
  Attempt other{{}, best.report};
  const bool is_made = try_on_sheet(p, other, context).empty();
  if (is_made && other.flaws() < best.flaws()) {
    best = std::move(other);
    return true;
  }
  best.report.times = std::move(other.report.times);
  return false;
}

/// Merges walls where triangles intersect, and makes the mesh anew, while that leaves fewer that do. Null where nothing
/// was merged.
std::unique_ptr<MergedWalls> merge_where_crossing(const PreparedSurface& p, Attempt& best, Context& context) {
  std::unique_ptr<MergedWalls> kept;
  std::vector<PointQ8> points;
  for (int merge = 0; merge < kMostMerges && best.report.optimize.self_intersections > 0; ++merge) {
    const std::vector<PointQ8> more = crossing_corners(*OnHost(best.made.mesh), {});
    points.insert(points.end(), more.begin(), more.end());
    sort_points(points);  // a mesh that stays has the same ones again
    auto merged = std::make_unique<MergedWalls>(
        timed(best.report, "merge", context, [&] { return merge_walls(p, points, merge, context); }));
    if (keep_better(merged->prepared, best, context)) kept = std::move(merged);
  }
  if (kept) report_merge(*kept, points, best.report);
  return kept;
}

/// A frame that cannot be meshed from the one before begins cold, where that gives a better mesh.
void begin_again_cold(const PreparedSurface& p, Attempt& best, Context& context) {
  const auto [failed, crossing] = best.flaws();
  if (!best.report.coherence.began_warm || (failed == 0 && crossing == 0)) return;
  if (!keep_better(p, best, context)) return;
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
SeedSet relax_without_creases(const PreparedSurface& p, RemeshReport& report, Context& context) {
  try {
    return relax_seeds(p, Begin::as_prepared, false, report, context);
  } catch (const NoRoom& error) {
    throw NoRoom(error.stage(),
                 std::string(error.what()) + "; creases could not be kept either: " + report.features.given_up);
  }
}

/// What is not as it should be.
void warn_of_mesh(const PreparedSurface& p, const SeededMesh& made, int64_t requested, RemeshReport& report) {
  if (report.dual.failed_cells > 0)
    report.warnings.push_back(
        std::to_string(report.dual.failed_cells) +
        " cells stay that are no disks: the result is not a closed 2-manifold; use a higher --resolution");
  if (made.seeds.size() > requested) report.count.why = "its topology needs them at this resolution";
  if (report.optimize.self_intersections == 0) return;
  const std::vector<PointQ8> corners = crossing_corners(*OnHost(made.mesh), {});
  const WorldPoint at = p.surface.frame.to_world(corners.empty() ? made.mesh.position[0] : corners.front());
  report.intersection_at = at;
  report.warnings.push_back(std::to_string(report.optimize.self_intersections) +
                            " pairs of triangles intersect, near " + readable_place(at, p.surface.frame) +
                            ": parts of the surface are nearer to one another than its edges are long; ask for more "
                            "--vertices");
}

/// A run whose edge lengths decide was asked for no number.
void report_count(const PreparedSurface& p, const TriangleMesh& mesh, RemeshReport& report) {
  CountReport& count = report.count;
  if (!p.options.edge_length_world && !p.vertices_of_lengths) count.asked = p.target.vertices;
  count.made = int64_t(mesh.vertices.size());
  if (!count.is_met()) report.warnings.push_back(count.words());
}

/// From relaxed seeds, with all that is tried where the mesh has flaws.
TriangleMesh triangulate_on_sheet(const PreparedSurface& p, Attempt& best, Context& context) {
  const int64_t requested = best.report.coherence.began_warm ? p.target.vertices : best.made.seeds.size();
  mesh_on_sheet(p, best.made, best.report, context);
  begin_again_cold(p, best, context);
  const std::unique_ptr<MergedWalls> merged = merge_where_crossing(p, best, context);
  const PreparedSurface& meshed = merged ? merged->prepared : p;
  warn_of_mesh(meshed, best.made, requested, best.report);
  measure_edges(meshed.sheet, best.made.seeds, best.made.mesh, best.report.sizing, context);
  TriangleMesh mesh = to_world(best.made.mesh, meshed.surface.frame);
  flag_gaps(meshed, OnHost(best.made.seeds)->home.view(), mesh, best.report.gaps);
  return mesh;
}

/// On its patches, or where that fails on the sheet without curves.
TriangleMesh triangulate_anyhow(const PreparedSurface& p, Attempt& best, Context& context) {
  if (p.walls) return triangulate_regions(p, best.made, patch_options(p, false), best.report, context);
  SheetWhenNeeded sheet(p, context);
  if (!p.cut || best.made.seeds.fixed.count == 0) return triangulate_on_sheet(sheet.get(best.report), best, context);
  const PatchOptions in_patches = patch_options(p, best.report.coherence.began_warm);
  if (std::optional<TriangleMesh> mesh = triangulate_patches(p, sheet, best.made, in_patches, best.report, context))
    return std::move(*mesh);
  best.report.optimize = {};
  const PreparedSurface& whole = sheet.get(best.report);
  if (is_on_own_triangles(p)) warn_of_topology(whole, p.surface.topology, best.report);
  best.made.seeds = relax_without_creases(whole, best.report, context);
  return triangulate_on_sheet(whole, best, context);
}

}  // namespace

Relaxed relax(const Prepared& prepared, Context& context) {
  const PreparedSurface& p = PreparedParts::of(prepared);
  Relaxed relaxed{{}, p.report};
  relaxed.seeds = relax_seeds(p, Begin::as_prepared, p.cut != nullptr, relaxed.report, context);
  return relaxed;
}

RemeshResult triangulate(const Prepared& prepared, Relaxed relaxed, Context& context) {
  const PreparedSurface& p = PreparedParts::of(prepared);
  Attempt best{{}, std::move(relaxed.report)};
  best.made.seeds = std::move(relaxed.seeds);
  TriangleMesh mesh = triangulate_anyhow(p, best, context);
  const bool is_in_patches = best.report.features.kept;
  report_count(p, mesh, best.report);
  follow_previous(p.options, best.report.coherence.began_warm && !is_in_patches, mesh, best.report);
  note_digest(p.options, best.report, context, "mesh", mesh);
  return {std::move(mesh), std::move(best.report)};
}

RemeshResult remesh(const TriangleSoup& soup, const RemeshOptions& requested, Context& context) {
  RemeshOptions options = requested;
  options.want_samples = false;
  Prepared prepared = prepare(soup, options, context);
  if (options.method == Method::sheet) prepared.free_samples();
  return triangulate(prepared, relax(prepared, context), context);
}

RemeshResult remesh(const TriangleMesh& mesh, const RemeshOptions& options, Context& context) {
  return remesh(surface_of(mesh), options, context);
}

}  // namespace isoshell
