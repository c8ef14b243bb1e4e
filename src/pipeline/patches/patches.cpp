// See patches.h.
#include "pipeline/patches/patches.h"

#include <algorithm>

#include "attributes/seams.h"
#include "core/copy_product.h"
#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "features/curves/find_curves.h"
#include "features/cutting/cut_surface.h"
#include "features/mesh/edge_subdivision.h"
#include "features/mesh/remove_slivers.h"
#include "geometry/half_edges.h"
#include "geometry/triangle_grid.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/distance.h"
#include "isoshell/error.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/readable.h"
#include "measure/crossing_corners.h"
#include "measure/crossings.h"
#include "pipeline/grid/attempt.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/patches/cut_curves.h"
#include "pipeline/patches/feature_report.h"
#include "pipeline/patches/given_lines.h"
#include "pipeline/patches/mend_patches.h"
#include "pipeline/patches/own_faces.h"
#include "pipeline/patches/part_fans.h"
#include "pipeline/patches/sheet_when_needed.h"
#include "pipeline/sheet/crease_search.h"
#include "pipeline/sheet/flag_gaps.h"
#include "pipeline/sheet/relax_meanwhile.h"

namespace isoshell {
namespace {

/// Flags vertices on faces that close gaps.
void flag_caps(const PreparedSurface& p, TriangleMesh& mesh, GapReport& report) {
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

/// Per vertex of the result the nearest corner of a sheet's nearest triangle.
std::vector<uint32_t> nearest_of_sheet(const Sheet& of, const TriangleMesh& mesh) {
  const OnHost<Sheet> on(of);
  TriangleMesh sheet;
  for (const PointQ8& p : on->position) sheet.vertices.push_back(of.frame.to_world(p));
  for (const TriangleIndices& t : on->triangles) sheet.triangles.push_back({t.a, t.b, t.c});
  const TriangleGrid grid(sheet);
  std::vector<uint32_t> nearest(mesh.vertices.size());
  for_each_index(size_t(0), nearest.size(), [&](size_t v) {
    const MeshPoint at = grid.nearest(mesh.vertices[v]);
    const double a_part = 1 - at.b_part - at.c_part;
    const size_t corner = at.b_part > std::max(a_part, at.c_part) ? 1 : at.c_part > a_part ? 2 : 0;
    nearest[v] = sheet.triangles[at.triangle][corner];
  });
  return nearest;
}

/// Of each curve that was found what is still one.
std::vector<double> kept_lengths_world(const CutSurface& cut) {
  std::vector<double> kept_world(cut.source->found.size(), 0);
  for (const CutCurve& curve : cut.curves)
    kept_world[curve.curve] += curve.length_q8 / kOneVoxelQ8 * cut.frame.voxel_size;
  for (size_t c = 0; c < kept_world.size(); ++c)
    kept_world[c] = std::min(kept_world[c], cut.source->found[c].length_world);
  return kept_world;
}

/// How long the curves are that the result has, and which it does not have: those that were left out, and those of
/// which less than half is kept.
void report_kept(const CutSurface& cut, FeatureReport& report, Run& run) {
  const std::vector<double> kept_world = kept_lengths_world(cut);
  std::vector<LostCurve> lost = cut.source->left_out;
  for (size_t c = 0; c < kept_world.size(); ++c) {
    const LostCurve& found = cut.source->found[c];
    if (found.kind != name_of(CurveKind::border)) report.kept_length_world += kept_world[c];
    if (2 * kept_world[c] >= found.length_world) continue;
    lost.push_back(found);
    lost.back().reason = kEdgesTooLong;
  }
  report.kept_length_world = std::min(report.kept_length_world, report.length_world);  // edges of three faces, too
  report_left_out(lost, cut.frame, report, run);
}

/// Says which attributes have none that could be kept.
Seams seams_of(const TriangleSoup* source, const RemeshOptions& options, double edge_length_world, Run& run) {
  if (!source || source->attributes.empty()) return {};
  return run.timed("features", [&] {
    Seams seams = find_seams(*source, options.uv_seams, edge_length_world);
    for (const DroppedAttribute& d : seams.dropped)
      run.warn("triangles may lie across the seams of " + d.name + ": " + d.reason);
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

/// What the search found that began with the surface, or the surface alone. The edges `kept` are still there.
SearchedSurface searched_surface(const PreparedSurface& p, const std::vector<std::array<WorldPoint, 2>>& kept,
                                 const Context& context) {
  if (p.creases && p.creases->has_result()) {
    SearchedSurface searched = p.creases->result();
    if (kept.empty() || !searched.had_slivers) return searched;
  }
  SearchedSurface alone{feature_mesh_of(*OnHost(p.surface), context), false, {}};
  run_with_threads(context, [&] {
    std::vector<uint64_t> keys;
    for (const auto& [u, v] : vertices_of(kept, alone.mesh, p.surface.frame)) keys.push_back(edge_key(u, v));
    std::sort(keys.begin(), keys.end());
    alone.had_slivers = remove_slivers(alone.mesh, p.surface.frame, keys, edge_of_strips_world(p), context);
  });
  return alone;
}

/// Forgets which curves were lost beside seams, from the first on: they have another try.
void keep_lost_seams(std::vector<LostCurve>& lost, size_t first) {
  const auto is_no_seam = [](const LostCurve& curve) { return curve.kind != name_of(CurveKind::seam); };
  lost.erase(std::remove_if(lost.begin() + int64_t(first), lost.end(), is_no_seam), lost.end());
}

/// The mesh of patches, or why there is none.
struct MeshOfPatches : MeshedPatches {
  TriangleMesh mesh;
};

MeshOfPatches mesh_of_patches(const PreparedSurface& p, int64_t border_loops, SeededMesh& made,
                              const PatchOptions& options, Run& run) {
  MeshOfPatches out{join_patches(p, *p.cut, made, options, run), {}};
  if (!out.why_not.empty()) return out;
  out.mesh = to_world(out.joined.mesh, p.surface.frame);
  out.mesh.features = std::move(out.joined.features);
  part_fans(out.mesh, p.surface.frame.voxel_size / kOneVoxelQ8);
  if (!check_mesh(out.mesh).is_manifold_with(border_loops)) out.why_not = "parts that touch would make no manifold";
  return out;
}

/// Of the mesh as it is: widening angles may have ended some that its patches had. Result: where the first is.
std::optional<WorldPoint> tell_intersections(const LatticeFrame& frame, MeshOfPatches& made, Run& run) {
  const DualMesh& mesh = made.joined.mesh;
  const auto crossings =
      int64_t(crossing_pairs(mesh.position.view(), mesh.triangles.view(), {}, run.context.cancel).size());
  made.optimize.self_intersections = crossings;
  if (crossings == 0) return {};
  const WorldPoint at = frame.to_world(crossing_corners(mesh, {}).front());
  run.warn(counted(crossings, "pair of triangles intersects", "pairs of triangles intersect") + ", near " +
           readable_place(at, frame) + ", where the input's own triangles do");
  return at;
}

}  // namespace

bool is_on_own_triangles(const PreparedSurface& p) { return p.cut && !p.cut->source->is_sheet; }

void cut_into_patches(const PatchSource& source, PreparedSurface& p, Run& run) {
  const RemeshOptions& options = p.options;
  if (options.method != Method::sheet) return;
  Context& context = run.context;
  const double edge_world = (p.grown ? p.target_of_input : p.target).edge_length_world;
  const Seams seams = seams_of(source.soup, options, edge_world, run);
  const std::shared_ptr<const Polylines>& lines = options.features.lines;
  const bool needs_cut = p.needs_own_triangles || may_keep_borders(p);
  if (options.features.creases == Features::Creases::off && seams.edges.empty() && !lines && !needs_cut) return;
  const bool may_be_uncut = seams.edges.empty() && source.interfaces.empty() && !needs_cut;
  if (may_be_uncut) relax_meanwhile(p, run);
  run.timed("features", [&] {
    std::vector<std::array<WorldPoint, 2>> kept = seams.edges;
    kept.insert(kept.end(), source.interfaces.begin(), source.interfaces.end());
    SearchedSurface searched = searched_surface(p, kept, context);
    CurveOptions curves = curve_options(options, p.previous.get(), edge_world);
    if (!searched.creases && !lines)
      searched.creases = run_with_threads(context, [&] { return find_creases(searched.mesh, curves); });
    const bool is_closed = p.surface.topology.closed && p.surface.topology.oriented;
    const bool is_cut = p.needs_own_triangles || (searched.creases && !searched.creases->curve_edges.empty());
    if (is_closed && seams.edges.empty() && !lines && is_cut) unite_own_faces(searched, p, run);
    FeatureMesh& mesh = searched.mesh;
    FeatureReport& found = p.report.features;
    curves.seams = vertices_of(seams.edges, mesh, p.surface.frame);
    if (curves.mode != CreaseMode::off) curves.interfaces = vertices_of(source.interfaces, mesh, p.surface.frame);
    if (lines) {
      MeshWithLines embedded = with_given_lines(std::move(mesh), *lines, {curves.seams, curves.interfaces}, edge_world,
                                                p.surface.frame.voxel_size, found.lost, run);
      mesh = std::move(embedded.mesh);
      curves.seams = std::move(embedded.followed[0]);
      curves.interfaces = std::move(embedded.followed[1]);
      curves.lines = std::move(embedded.edges);
    }
    const size_t lost_lines = found.lost.size();
    if (cut_along(mesh, curves, std::move(searched.creases), p, run) || curves.seams.empty()) {
      if (p.creases) p.creases->free_meanwhile(std::move(searched));
      return;
    }
    keep_lost_seams(found.lost, lost_lines);
    const int64_t seams_apart = found.seams;  // from creases and borders
    run.warnings.back() = (seams_apart > 0 ? counted(seams_apart, "seam") : "seams along other curves") +
                          " are not kept: " + found.given_up + "; triangles lie across seams";
    curves.seams.clear();
    cut_along(mesh, curves, {}, p, run);
  });
}

std::optional<TriangleMesh> triangulate_patches(const PreparedSurface& p, SeededMesh& made, PatchOptions in_patches,
                                                RemeshReport& report, Run& run) {
  FeatureReport& features = report.features;
  MeshOfPatches made_here = mesh_of_patches(p, features.border_loops, made, in_patches, run);
  if (!made_here.why_not.empty() && std::exchange(in_patches.previous, nullptr)) {
    report.coherence.began_warm = false;
    report.coherence.why_cold = made_here.why_not;
    RelaxedSeeds relaxed = run.timed("relax", [&] { return relax_in_patches(*p.cut, in_patches, run.context); });
    made = {{}, std::move(relaxed.seeds)};
    report.relax = std::move(relaxed.report);
    made_here = mesh_of_patches(p, features.border_loops, made, in_patches, run);
  }
  if (!made_here.why_not.empty()) {
    if (p.cut->curves.empty())
      run.warn("the surface is meshed on its voxels, not on its own triangles: " + made_here.why_not);
    else
      give_up(p.cut->source->if_lost, made_here.why_not, features, run);
    return {};
  }
  const CutSurface& cut = *p.cut;
  TriangleMesh& mesh = made_here.mesh;
  if (made_here.optimize.self_intersections > 0)
    report.intersection_at = tell_intersections(p.surface.frame, made_here, run);
  report.dual = made_here.dual;
  report.optimize = made_here.optimize;
  report.count.why = p.cut->curves.empty() ? "parts of the surface are nearer to one another than edges are long"
                                           : "its curves need them, or leave no room for more";
  warn_of_left_alone(made_here.joined.left_alone, run);
  if (cut.source->is_sheet) {
    const std::vector<uint32_t> at = run_with_threads(run.context, [&] { return nearest_of_sheet(p.sheet, mesh); });
    flag_gaps(p, {at.data(), int64_t(at.size())}, mesh, report.gaps);
    run.warn("curves are kept on the sheet, not on the input's own triangles: " + features.on_sheet);
  } else {
    report.grid.closing_vox = report.grid.grown_vox = 0;  // those of the sheet, which is not used
    report.sheet.agrees = report.sheet.is_compared;
    if (p.grown) {  // the sheet is that of another solid
      report.sheet.topology.components = p.surface.topology.components;
      report.sheet.topology.genus = p.surface.topology.genus;
    }
    report.sheet.topology.bridged_vertices = 0;
    flag_caps(p, mesh, report.gaps);
  }
  measure_edges(cut, made_here.joined, report.sizing);
  features.vertices = made_here.joined.on_curves;
  features.segments = int64_t(mesh.features.curve_edges.size());
  report.is_optimized = true;
  features.kept = !cut.curves.empty();
  report_kept(cut, features, run);
  return std::move(mesh);
}

}  // namespace isoshell
