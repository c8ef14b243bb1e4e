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
SeedSet relax_seeds(const PreparedSurface& p, bool in_patches, RemeshReport& report, Context& context) {
  if (p.walls && p.walls->are_too_near) return {};
  const bool is_warm = report.coherence.began_warm = p.previous != nullptr;
  RelaxedSeeds relaxed;
  if (!in_patches && !is_warm && p.options.method == Method::shell)
    relaxed = relaxed_in_shell(p, report, context);
  else
    relaxed = timed(report, "relax", context, [&] {
      if (in_patches) return relax_in_patches(*p.cut, patch_options(p, p.cut->seeds, is_warm), context);
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
  make_dual_of_seeds(p.sheet, {count, is_warm}, made, report, context);
  if (report.dual.failed_cells > 0) return;
  OptimizedMesh optimized =
      timed(report, "post", context, [&] { return optimize_mesh(p.sheet, std::move(made), options, context); });
  report.optimize = optimized.report;
  made = std::move(optimized);
  report.is_optimized = true;
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
    return relax_seeds(p, false, report, context);
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

/// A result, and whether its vertices have the numbers that they have in the frame before.
struct Triangulated {
  TriangleMesh mesh;
  bool has_numbers = false;
};

/// Cells with flaws are mended. None where there is no room or memory for that: the mesh stays as it is then.
std::optional<JoinedPatches> mended_on_sheet(const PreparedSurface& p, const SeededMesh& made, int64_t vertices,
                                             RemeshReport& report, Context& context) {
  std::optional<JoinedPatches> mended;
  try {
    failure_reason([&]() -> std::string {
      mended = mend_sheet(p, made, patch_options(p, vertices, false), report, context);
      return "";
    });
  } catch (const Error& error) {
    if (error.code() != ErrorCode::out_of_memory) throw;
  }
  if (!mended) return {};
  report.dual.failed_cells = 0;
  report.is_optimized = true;
  if (mended->mesh.position.size() > vertices)
    report.count.why = "parts of the surface are nearer to one another than edges are long";
  return mended;
}

/// From relaxed seeds.
Triangulated triangulate_on_sheet(const PreparedSurface& p, SeededMesh& made, RemeshReport& report, Context& context) {
  const bool is_warm = report.coherence.began_warm;
  const int64_t requested = is_warm ? p.target.vertices : made.seeds.size();
  mesh_on_sheet(p, made, report, context);
  Triangulated out;
  std::optional<JoinedPatches> mended;
  if (report.dual.failed_cells + report.optimize.self_intersections > 0)
    mended = mended_on_sheet(p, made, requested, report, context);
  if (mended) {
    out.mesh = to_world(mended->mesh, p.surface.frame);
    flag_gaps(p, mended->home.view(), out.mesh, report.gaps);
    return out;
  }
  warn_of_mesh(p, made, requested, report);
  measure_edges(p.sheet, made.seeds, made.mesh, report.sizing, context);
  out = {to_world(made.mesh, p.surface.frame), is_warm};
  flag_gaps(p, OnHost(made.seeds)->home.view(), out.mesh, report.gaps);
  return out;
}

/// On its patches, or where that fails on the sheet without curves.
Triangulated triangulate_anyhow(const PreparedSurface& p, SeededMesh& made, RemeshReport& report, Context& context) {
  if (p.walls) return {triangulate_regions(p, made, patch_options(p, p.cut->seeds, false), report, context)};
  SheetWhenNeeded sheet(p, context);
  if (!p.cut || made.seeds.fixed.count == 0) return triangulate_on_sheet(sheet.get(report), made, report, context);
  const PatchOptions in_patches = patch_options(p, p.cut->seeds, report.coherence.began_warm);
  if (std::optional<TriangleMesh> mesh = triangulate_patches(p, sheet, made, in_patches, report, context))
    return {std::move(*mesh)};
  report.optimize = {};
  const PreparedSurface& whole = sheet.get(report);
  if (is_on_own_triangles(p)) warn_of_topology(whole, p.surface.topology, report);
  made.seeds = relax_without_creases(whole, report, context);
  return triangulate_on_sheet(whole, made, report, context);
}

}  // namespace

Relaxed relax(const Prepared& prepared, Context& context) {
  const PreparedSurface& p = PreparedParts::of(prepared);
  Relaxed relaxed{{}, p.report};
  relaxed.seeds = relax_seeds(p, p.cut != nullptr, relaxed.report, context);
  return relaxed;
}

RemeshResult triangulate(const Prepared& prepared, Relaxed relaxed, Context& context) {
  const PreparedSurface& p = PreparedParts::of(prepared);
  RemeshReport report = std::move(relaxed.report);
  SeededMesh made;
  made.seeds = std::move(relaxed.seeds);
  Triangulated out = triangulate_anyhow(p, made, report, context);
  report_count(p, out.mesh, report);
  follow_previous(p.options, out.has_numbers, out.mesh, report);
  note_digest(p.options, report, context, "mesh", out.mesh);
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
