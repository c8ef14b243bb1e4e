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
#include "pipeline/patches/mend_sheet.h"
#include "pipeline/patches/patches.h"
#include "pipeline/patches/sheet_when_needed.h"
#include "pipeline/regions/mesh_of_regions.h"
#include "pipeline/regions/region_walls.h"
#include "pipeline/sheet/dual_of_seeds.h"
#include "pipeline/sheet/flag_gaps.h"
#include "pipeline/sheet/relax_meanwhile.h"
#include "pipeline/sheet/warm_start.h"

namespace isoshell {
namespace {

PatchOptions patch_options(const PreparedSurface& p, int64_t vertices, bool is_warm) {
  return {{vertices, p.options.seed},
          relax_options(p.options),
          p.options.tolerance.has_value(),
          optimize_options(p.options),
          is_warm ? p.previous : nullptr};
}

RelaxedSeeds relaxed_in_shell(const PreparedSurface& p, Run& run) {
  Context& context = run.context;
  const SeedOptions seeds{p.target.vertices, p.options.seed};
  SeedSet start = run.timed("seeds", [&] { return place_seeds(p.sites, p.samples, seeds, context); });
  RelaxedSeeds relaxed = run.timed("relax", [&] {
    return relax_in_shell(p.shell, p.sites, p.samples, std::move(start), relax_options(p.options), context);
  });
  relaxed.seeds = run.timed("attach", [&] { return attach_to_sheet(p.sheet, std::move(relaxed.seeds), 0, context); });
  return relaxed;
}

/// On the patches of a cut surface, or on the sheet. None where a mesh is to be made without.
SeedSet relax_seeds(const PreparedSurface& p, bool in_patches, RemeshReport& report, Run& run) {
  if (p.walls && p.walls->are_too_near) return {};
  const bool is_warm = report.coherence.began_warm = p.previous != nullptr;
  RelaxedSeeds relaxed;
  if (!in_patches && !is_warm && p.options.method == Method::shell)
    relaxed = relaxed_in_shell(p, run);
  else
    relaxed = run.timed("relax", [&] {
      if (in_patches) return relax_in_patches(*p.cut, patch_options(p, p.cut->seeds, is_warm), run.context);
      return is_warm ? relaxed_from_previous(p, run.context) : relaxed_by_levels(p, run.context);
    });
  report.relax = std::move(relaxed.report);
  report.seeds = relaxed.seeds.size();
  run.note_digest("seeds", relaxed.seeds);
  return std::move(relaxed.seeds);
}

/// Numbers as in the frame before, where the mesh has not kept them, and how steady the frame is.
void follow_previous(const RemeshOptions& options, bool has_numbers, TriangleMesh& mesh, CoherenceReport& report) {
  if (!options.previous) return;
  if (!has_numbers) number_as_before(*options.previous, mesh);
  measure_coherence(*options.previous, mesh, report);
}

/// Where triangles intersect, with a warning. None where none do.
std::optional<WorldPoint> warn_of_intersections(const LatticeFrame& frame, const SeededMesh& made, int64_t pairs,
                                                Run& run) {
  if (pairs == 0) return {};
  const std::vector<PointQ8> corners = crossing_corners(*OnHost(made.mesh), {});
  const WorldPoint at = frame.to_world(corners.empty() ? made.mesh.position[0] : corners.front());
  run.warn(std::to_string(pairs) + " pairs of triangles intersect, near " + readable_place(at, frame) +
           ": parts of the surface are nearer to one another than its edges are long; ask for more "
           "--vertices");
  return at;
}

/// Warns where it is another than the one asked for, which a run whose edge lengths decide has not.
void report_count(const PreparedSurface& p, const TriangleMesh& mesh, CountReport& count, Run& run) {
  if (!p.options.edge_length_world && !p.vertices_of_lengths) count.asked = p.target.vertices;
  count.made = int64_t(mesh.vertices.size());
  if (!count.is_met()) run.warn(count.words());
}

/// A result, and whether its vertices have the numbers that they have in the frame before.
struct Triangulated {
  TriangleMesh mesh;
  bool has_numbers = false;
};

/// Cells with flaws are mended. None where there is no room or memory for that: the mesh stays as it is then.
std::optional<MendedPatches> mended_on_sheet(const PreparedSurface& p, const SeededMesh& made,
                                             const OptimizeReport& optimized, int64_t vertices, Run& run) {
  std::optional<MendedPatches> mended;
  try {
    failure_reason([&]() -> std::string {
      mended = mend_sheet(p, made, optimized, patch_options(p, vertices, false), run);
      return "";
    });
  } catch (const Error& error) {
    if (error.code() != ErrorCode::out_of_memory) throw;
  }
  return mended;
}

/// Dual, repair and the final mesh, from relaxed seeds.
Triangulated triangulate_on_sheet(const PreparedSurface& p, SeededMesh& made, RemeshReport& report, Run& run) {
  report.grid = p.report.grid;
  report.sheet = p.report.sheet;
  const bool is_warm = report.coherence.began_warm;
  const int64_t requested = is_warm ? p.target.vertices : made.seeds.size();
  report.dual = make_dual_of_seeds(p.sheet, {requested, is_warm}, made, run);
  report.is_optimized = report.dual.failed_cells == 0;
  report.optimize = {};
  if (report.is_optimized) {
    const OptimizeOptions usual = optimize_options(p.options), options = is_warm ? for_warm_frame(usual) : usual;
    OptimizedMesh optimized =
        run.timed("post", [&] { return optimize_mesh(p.sheet, std::move(made), options, run.context); });
    report.optimize = optimized.report;
    made = std::move(optimized);
  }
  std::optional<MendedPatches> mended;
  if (!report.is_optimized || report.optimize.self_intersections > 0)
    mended = mended_on_sheet(p, made, report.optimize, requested, run);
  Triangulated out;
  if (mended) {
    report.dual.failed_cells = 0;
    report.is_optimized = true;
    report.optimize = mended->optimize;
    report.sizing = mended->sizing;
    const JoinedPatches& joined = mended->joined;
    if (joined.mesh.position.size() > requested)
      report.count.why = "parts of the surface are nearer to one another than edges are long";
    out.mesh = to_world(joined.mesh, p.surface.frame);
    flag_gaps(p, joined.home.view(), out.mesh, report.gaps);
    return out;
  }
  if (!report.is_optimized)
    run.warn(std::to_string(report.dual.failed_cells) +
             " cells stay that are no disks: the result is not a closed 2-manifold; use a higher --resolution");
  if (made.seeds.size() > requested) report.count.why = "its topology needs them at this resolution";
  report.intersection_at = warn_of_intersections(p.surface.frame, made, report.optimize.self_intersections, run);
  measure_edges(p.sheet, made.seeds, made.mesh, report.sizing, run.context);
  out = {to_world(made.mesh, p.surface.frame), is_warm};
  flag_gaps(p, OnHost(made.seeds)->home.view(), out.mesh, report.gaps);
  return out;
}

/// On its patches, or where that fails on the sheet without curves.
Triangulated triangulate_anyhow(const PreparedSurface& p, SeededMesh& made, RemeshReport& report, Run& run) {
  if (p.walls) return {triangulate_regions(p, made, patch_options(p, p.cut->seeds, false), report, run)};
  SheetWhenNeeded sheet(p, run);
  const bool is_in_patches = p.cut && (made.seeds.fixed.count > 0 || p.needs_own_triangles);
  if (!is_in_patches) return triangulate_on_sheet(sheet.get(), made, report, run);
  const PatchOptions in_patches = patch_options(p, p.cut->seeds, report.coherence.began_warm);
  if (std::optional<TriangleMesh> mesh = triangulate_patches(p, made, in_patches, report, run))
    return {std::move(*mesh)};
  const PreparedSurface& whole = sheet.get();
  if (is_on_own_triangles(p)) warn_of_topology(whole, p.surface.topology, run);
  try {
    made.seeds = relax_seeds(whole, false, report, run);
  } catch (const NoRoom& error) {  // where the grid is too coarse for that, too, the error says why it is tried
    if (report.features.given_up.empty()) throw;
    throw NoRoom(error.stage(),
                 std::string(error.what()) + "; creases could not be kept either: " + report.features.given_up);
  }
  return triangulate_on_sheet(whole, made, report, run);
}

}  // namespace

Relaxed relax(const Prepared& prepared, Context& context) {
  const PreparedSurface& p = PreparedParts::of(prepared);
  Relaxed relaxed{{}, p.report};
  Run run{context, p.options.want_digests};
  run.exchange_log(relaxed.report);
  relaxed.seeds = relax_seeds(p, p.cut != nullptr, relaxed.report, run);
  run.exchange_log(relaxed.report);
  return relaxed;
}

RemeshResult triangulate(const Prepared& prepared, Relaxed relaxed, Context& context) {
  const PreparedSurface& p = PreparedParts::of(prepared);
  RemeshReport report = std::move(relaxed.report);
  Run run{context, p.options.want_digests};
  run.exchange_log(report);
  SeededMesh made;
  made.seeds = std::move(relaxed.seeds);
  Triangulated out = triangulate_anyhow(p, made, report, run);
  report_count(p, out.mesh, report.count, run);
  follow_previous(p.options, out.has_numbers, out.mesh, report.coherence);
  run.note_digest("mesh", out.mesh);
  run.exchange_log(report);
  return {std::move(out.mesh), std::move(report)};
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
