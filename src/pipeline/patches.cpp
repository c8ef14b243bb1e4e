// See patches.h.
#include "pipeline/patches.h"

#include <algorithm>
#include <numeric>

#include "attributes/seams.h"
#include "core/copy_product.h"
#include "core/triangle_grid.h"
#include "core/world_vector.h"
#include "features/curve_seeds.h"
#include "features/cut_surface.h"
#include "features/find_curves.h"
#include "features/free_seeds.h"
#include "features/halve_segments.h"
#include "features/separate_fans.h"
#include "features/split_edges.h"
#include "features/weld_for_features.h"
#include "features/widen_angles.h"
#include "isoshell/distance.h"
#include "isoshell/error.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/readable.h"
#include "isoshell/to_host.h"
#include "measure/crossing_corners.h"
#include "measure/crossings.h"
#include "pipeline/choose_grid.h"
#include "pipeline/cut_curves.h"
#include "pipeline/dual_of_seeds.h"
#include "pipeline/feature_report.h"
#include "pipeline/given_lines.h"
#include "pipeline/part_fans.h"
#include "pipeline/patch_defects.h"
#include "pipeline/relax_level.h"
#include "pipeline/resolve_intersections.h"
#include "pipeline/sizing.h"
#include "pipeline/timed.h"

namespace isoshell {
namespace {

CurveOptions curve_options(const RemeshOptions& options, double edge_length_world) {
  const Features::Creases creases = options.features.creases;
  const CreaseMode mode = creases == Features::Creases::off         ? CreaseMode::off
                          : creases == Features::Creases::automatic ? CreaseMode::automatic
                                                                    : CreaseMode::threshold;
  return {mode, options.features.degrees, edge_length_world};
}

constexpr int kRoundsOfShorterSegments = 1, kRoundsOfFewerCurves = 4;  ///< each costs a whole relaxation

/// The snapped surface: what a stage file holds, so that a run that resumes finds the same features.
TriangleSoup soup_of(const LatticeSurface& surface) {
  TriangleMesh mesh = to_world(surface);
  TriangleSoup soup;
  soup.vertices = std::move(mesh.vertices);
  soup.triangles = std::move(mesh.triangles);
  return soup;
}

SeededMesh fetched(const SeededMesh& made) {
  SeededMesh out;
  out.mesh = to_host(made.mesh);
  out.seeds = to_host(made.seeds);
  return out;
}

/// As many boxes of intersections of the result as are farther than an edge from those of the input.
int64_t count_new_crossings(const Prepared& p, const DualMesh& mesh, Context& context) {
  const OnHost<LatticeSurface> input(p.surface);
  const auto edge_q8 = int32_t(p.cut->longest_edge_q8);
  return count_apart(find_crossings(mesh.position.view(), mesh.triangles.view(), context),
                     find_crossings(input->points.view(), input->triangles.view(), context), edge_q8);
}

/// Flags vertices on faces that close gaps.
void flag_caps(const Prepared& p, TriangleMesh& mesh, GapReport& report) {
  const uint32_t first_cap = p.surface.first_cap;
  if (first_cap == kNone) return;
  const OnHost<LatticeSurface> surface(p.surface);
  const TriangleMesh input = to_world(*surface);
  const TriangleGrid grid(input);
  mesh.gap.resize(mesh.vertices.size());
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    report.vertices += mesh.gap[v] = surface->source_face[grid.nearest(mesh.vertices[v]).triangle] >= first_cap;
  for (size_t t = 0; t < input.triangles.size(); ++t) {
    const auto& [a, b, c] = input.triangles[t];
    if (surface->source_face[int64_t(t)] >= first_cap)
      report.area_world += triangle_area(input.vertices[a], input.vertices[b], input.vertices[c]);
  }
}

/// Whether triangles intersect nowhere but, with borders that are kept, where the input's do.
bool has_no_new_crossings(const Prepared& p, const SeededMesh& made, const RemeshReport& report, Context& context) {
  if (report.post.self_intersections == 0) return true;
  if (report.features.border_loops == 0) return false;
  return count_new_crossings(p, join_patches(*OnHost(made.mesh), OnHost(made.seeds)->fixed).mesh, context) == 0;
}

/// Makes the mesh of relaxed seeds. Result: why it cannot be the run's; empty where it can.
std::string mesh_patches(const Prepared& p, const CutSurface& cut, SeededMesh& made, const OptimizeOptions& options,
                         RemeshReport& report, Context& context) {
  const int64_t asked = made.seeds.size();
  report.post = {};
  make_dual_of_seeds(cut.surface, {asked}, made, report, context);
  if (report.dual.failed_cells > 0) return std::to_string(report.dual.failed_cells) + " cells beside them are no disks";
  if (made.seeds.size() != asked)
    return "the patches take " + std::to_string(made.seeds.size() - asked) + " vertices more";
  OptimizedMesh optimized =
      timed(report, "post", context, [&] { return optimize_mesh(cut.surface, std::move(made), options, context); });
  report.post = optimized.report;
  made = std::move(optimized);
  if (has_no_new_crossings(p, made, report, context)) return "";
  timed(report, "untangle", context, [&] { resolve_intersections(cut.surface, options, made, report, context); });
  if (has_no_new_crossings(p, made, report, context)) return "";
  return std::to_string(report.post.self_intersections) + " pairs of triangles would intersect";
}

/// The patches put together, with better angles beside curves; it intersects itself no more than before.
JoinedPatches with_wide_angles(const Prepared& p, const CutSurface& cut, const SeededMesh& made,
                               const RemeshReport& report, Context& context) {
  const bool may_cross = report.post.self_intersections > 0;  // where the input does
  const auto crossings = [&](const DualMesh& mesh) {
    const bool is_clean = may_cross && count_new_crossings(p, mesh, context) == 0;
    return is_clean ? std::vector<PointQ8>() : crossing_corners(mesh, {});
  };
  return join_and_widen(cut, made, crossings, context);
}

/// With more seeds on the curves near triangles that intersect; null where there is no curve.
std::shared_ptr<const CutSurface> with_shorter_segments(const CutSurface& cut, const SeededMesh& made) {
  const OnHost<SeedSet> seeds(made.seeds);
  std::optional<CutSurface> shorter =
      halve_segments(cut, crossing_corners(*OnHost(made.mesh), seeds->fixed.joined.view()), cut.longest_edge_q8);
  return shorter ? std::make_shared<CutSurface>(std::move(*shorter)) : nullptr;
}

/// The mesh of relaxed seeds; where triangles intersect, curves get more seeds there, and all seeds relax again.
/// Result: why it cannot be the run's; empty where it can. `cut` becomes the surface that it is on.
std::string mesh_in_rounds(const Prepared& p, std::shared_ptr<const CutSurface>& cut, SeededMesh& made,
                           const PatchOptions& options, RemeshReport& report, Context& context) {
  return reason_against([&] {
    std::string why = mesh_patches(p, *cut, made, options.optimize, report, context);
    const auto intersects = [&] { return !why.empty() && report.post.self_intersections > 0; };
    for (int rounds = kRoundsOfShorterSegments; intersects() && rounds > 0; --rounds) {
      const std::shared_ptr<const CutSurface> shorter = with_shorter_segments(*cut, made);
      if (!shorter) break;
      cut = shorter;
      made.seeds = timed(report, "relax", context, [&] { return relax_in_patches(*cut, options, context).seeds; });
      why = mesh_patches(p, *cut, made, options.optimize, report, context);
    }
    return why;
  });
}

/// Where triangles of a mesh that cannot be the run's are wrong.
std::vector<PointQ8> wrong_places(const SeededMesh& made, const RemeshReport& report) {
  if (report.dual.failed_cells > 0) return find_patch_defects(made);
  return crossing_corners(*OnHost(made.mesh), OnHost(made.seeds)->fixed.joined.view());
}

/// The same once without curves that cannot be followed. Result: `why` where there are none to leave out.
std::string mesh_without_some_curves(const Prepared& p, std::shared_ptr<const CutSurface>& cut, SeededMesh& made,
                                     PatchOptions options, const std::string& why, RemeshReport& report,
                                     Context& context) {
  const std::string against = reason_against([&] {
    const std::shared_ptr<const CutSurface> fewer = timed(report, "features", context, [&] {
      return cut_along_fewer(*cut->source, wrong_places(made, report), p.surface.frame, report, context);
    });
    if (!fewer) return why;
    cut = fewer;
    options.seeds.count = cut->seeds;
    made.seeds = timed(report, "relax", context, [&] { return relax_in_patches(*cut, options, context).seeds; });
    return std::string();
  });
  return against.empty() ? mesh_in_rounds(p, cut, made, options, report, context) : against;
}

/// The mesh with as many curves as can be kept. Result: why there is none; empty where there is.
std::string mesh_with_curves(const Prepared& p, std::shared_ptr<const CutSurface>& cut, SeededMesh& made,
                             const PatchOptions& options, RemeshReport& report, Context& context) {
  const FeatureReport all = report.features;
  std::string why = mesh_in_rounds(p, cut, made, options, report, context);
  for (int rounds = kRoundsOfFewerCurves; !why.empty() && rounds > 0; --rounds) {
    const std::shared_ptr<const CutSurface> before = cut;
    why = mesh_without_some_curves(p, cut, made, options, why, report, context);
    if (cut == before) break;
  }
  if (!why.empty()) report.features = all;
  return why;
}

/// Says which attributes have none that could be kept.
Seams seams_of(const TriangleSoup* source, const RemeshOptions& options, double edge_length_world, RemeshReport& report,
               Context& context) {
  if (!source || source->attributes.empty()) return {};
  return timed(report, "features", context, [&] {
    Seams seams = find_seams(*source, options.attributes, edge_length_world);
    for (const DroppedAttribute& d : seams.dropped)
      report.warnings.push_back("triangles may lie across the seams of " + d.name + ": " + d.reason);
    return seams;
  });
}

/// The mesh's vertices where the ends of edges were snapped to; of edges that are no longer there none.
EdgeList vertices_of(const std::vector<std::array<WorldPoint, 2>>& edges, const FeatureMesh& mesh,
                     const LatticeFrame& frame) {
  EdgeList found;
  for (const auto& edge : edges) {
    std::array<uint32_t, 2> vertex{kNone, kNone};
    for (size_t i = 0; i < 2; ++i) {
      const WorldPoint p = frame.to_world(frame.snap(edge[i]));
      const auto at = std::lower_bound(mesh.vertices.begin(), mesh.vertices.end(), p, is_before);
      if (at != mesh.vertices.end() && !is_before(p, *at)) vertex[i] = uint32_t(at - mesh.vertices.begin());
    }
    if (vertex[0] != kNone && vertex[1] != kNone && vertex[0] != vertex[1]) found.push_back(vertex);
  }
  return found;
}

/// Forgets which curves were lost beside seams, from the first on: they have another try.
void keep_lost_seams(std::vector<LostCurve>& lost, size_t first) {
  const auto is_no_seam = [](const LostCurve& curve) { return curve.kind != name_of(CurveKind::seam); };
  lost.erase(std::remove_if(lost.begin() + int64_t(first), lost.end(), is_no_seam), lost.end());
}

}  // namespace

void cut_into_patches(const RemeshOptions& options, const PatchSource& source, Prepared& p, RemeshReport& report,
                      Context& context) {
  if (options.method != Method::sheet) return;
  const double edge_world = usual_edge_length(options, p);
  const Seams seams = seams_of(source.soup, options, edge_world, report, context);
  const std::shared_ptr<const Polylines>& lines = options.features.lines;
  if (options.features.creases == Features::Creases::off && seams.edges.empty() && !lines &&
      !may_keep_borders(options, p))
    return;
  timed(report, "features", context, [&] {
    FeatureMesh mesh = weld_for_features(soup_of(*OnHost(p.surface)));
    CurveOptions curves = curve_options(options, edge_world);
    curves.seams = vertices_of(seams.edges, mesh, p.surface.frame);
    if (curves.mode != CreaseMode::off) curves.lines = vertices_of(source.interfaces, mesh, p.surface.frame);
    if (lines) {
      MeshWithLines embedded = with_given_lines(std::move(mesh), *lines, {curves.seams, curves.lines}, edge_world,
                                                p.surface.frame.voxel_size, report);
      mesh = std::move(embedded.mesh);
      curves.seams = std::move(embedded.followed[0]);
      curves.lines = std::move(embedded.followed[1]);
      curves.lines.insert(curves.lines.end(), embedded.edges.begin(), embedded.edges.end());
    }
    mesh.rounding_world = p.surface.frame.voxel_size / (2 * kOneVoxelQ8);
    const size_t lost_lines = report.features.lost.size();
    const auto welded = std::make_shared<const FeatureMesh>(std::move(mesh));
    if (cut_along(welded, curves, options, p, report, context) || curves.seams.empty()) return;
    keep_lost_seams(report.features.lost, lost_lines);
    const int64_t seams_apart = report.features.seams;  // from creases and borders
    report.warnings.back() = (seams_apart > 0 ? counted(seams_apart, "seam") : "seams along other curves") +
                             " are not kept: " + report.features.given_up + "; triangles lie across seams";
    curves.seams.clear();
    cut_along(welded, curves, options, p, report, context);
  });
}

RelaxedSeeds relax_in_patches(const CutSurface& cut, const PatchOptions& options, Context& context) {
  const FreeSeeds free_seeds(cut);
  std::vector<SeedSet> fixed;  // fine to coarse
  std::vector<FreeSeeds::Counts> counts;
  for (int level = 0; level < kMaxLevels; ++level) {
    SeedSet on_curves = seeds_on_curves(cut, level);
    FreeSeeds::Counts in_patches =
        level == 0 ? free_seeds.counts(on_curves, options.seeds.count) : free_seeds.coarser(on_curves, counts.back());
    if (level > 0 && std::accumulate(in_patches.begin(), in_patches.end(), on_curves.size()) < kFewestSeeds) break;
    fixed.push_back(std::move(on_curves));
    counts.push_back(std::move(in_patches));
  }
  std::optional<SeededMesh> coarser;
  for (size_t level = fixed.size(); level-- > 0;) {
    SeedSet seeds =
        coarser ? free_seeds.add_finer(std::move(fixed[level]), counts[level], fetched(*coarser), options.seeds.seed)
                : free_seeds.add(std::move(fixed[level]), counts[level], options.seeds.seed);
    if (level == 0) return relax_on_sheet(cut.surface, std::move(seeds), options.relax, context);
    coarser =
        relax_level(cut.surface, for_coarse_level(options.relax, options.tolerance_asked), std::move(seeds), context);
  }
  return {};
}

std::optional<TriangleMesh> triangulate_patches(const Prepared& p, SeededMesh& made, const PatchOptions& options,
                                                RemeshReport& report, Context& context) {
  std::shared_ptr<const CutSurface> cut = p.cut;
  std::string why = mesh_with_curves(p, cut, made, options, report, context);
  std::optional<TriangleMesh> mesh;
  JoinedPatches joined;
  if (why.empty())
    why = reason_against([&]() -> std::string {
      joined = timed(report, "angles", context, [&] { return with_wide_angles(p, *cut, made, report, context); });
      mesh = to_world(joined.mesh, p.surface.frame);
      mesh->features = std::move(joined.features);
      part_fans(*mesh, p.surface.frame.voxel_size / kOneVoxelQ8);
      const bool is_manifold = check_mesh(*mesh).is_manifold_with(report.features.border_loops);
      return is_manifold ? "" : "parts that touch would make no manifold";
    });
  if (!why.empty()) {
    give_up(report, p.cut->source->if_lost, why);
    return {};
  }
  if (const int64_t crossings = report.post.self_intersections; crossings > 0)
    report.warnings.push_back(counted(crossings, "pair of triangles intersects", "pairs of triangles intersect") +
                              " where the input's own triangles do");
  report.closing_vox = report.grown_vox = 0;  // those of the sheet, which is not used
  report.sheet.bridged_vertices = 0;
  flag_caps(p, *mesh, report.gaps);
  measure_edges(*cut, joined, report.sizing);
  report.features.vertices = joined.on_curves;
  report.features.segments = int64_t(mesh->features.curve_edges.size());
  report.features.kept = report.post_done = true;
  report_left_out(cut->source->left_out, report);
  return mesh;
}

}  // namespace isoshell
