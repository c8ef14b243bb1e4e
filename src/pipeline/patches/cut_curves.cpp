// See cut_curves.h.
#include "pipeline/patches/cut_curves.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "core/watched.h"
#include "features/cutting/curve_seeds.h"
#include "features/cutting/free_seeds.h"
#include "features/mesh/separate_fans.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "isoshell/mesh_topology.h"
#include "pipeline/grid/attempt.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/patches/feature_report.h"
#include "pipeline/patches/lay_on_sheet.h"

namespace isoshell {
namespace {

constexpr double kNearMost = 1.1;        ///< times as many are no reason to look again
constexpr int kMostLooks = 3;            ///< for creases that fit; edges are shorter where curves face others, once cut
constexpr double kMoreThanAsked = .08;   ///< vertices that lengths ask for, over those that there are
constexpr double kFewestByLength = 0.4;  ///< of the vertices: edges are 1 / sqrt(.4) times as long as without curves
constexpr int kMostCuts = 3;             ///< for lengths that leave curves and patches their share

/// Six times the volume inside: below 0 where faces look inwards. Measured from a vertex, for the sake of digits.
double six_volumes(const FeatureMesh& mesh) {
  double sum = 0;
  const WorldPoint& o = mesh.vertices[0];
  for (const auto& t : mesh.triangles)
    sum += dot(mesh.vertices[t[0]] - o, cross(mesh.vertices[t[1]] - o, mesh.vertices[t[2]] - o));
  return sum;
}

/// The same of a surface whose borders stay: gaps that had to be closed were closed by faces.
std::string obstacle_to_borders(const CurveNetwork& network) {
  if (count_kind(network, CurveKind::non_manifold) > 0)
    return "the surface has edges of more than two faces, or faces that disagree about the outside";
  return "";
}

/// What keeps the surface from being its own input's triangles; empty where nothing does. Faces that a union cut count
/// as closed whatever their edges are.
std::string obstacle(const PreparedSurface& p, const FeatureMesh& mesh, const CurveNetwork& network) {
  const InputTopology& input = p.surface.topology;
  const int64_t inside = count_kind(network, CurveKind::crease) + count_kind(network, CurveKind::seam) +
                         count_kind(network, CurveKind::line);
  if (!input.closed || !input.oriented || inside < int64_t(network.curves.size()))
    return "the surface has holes, edges of more than two faces, or faces that disagree about the outside";
  if (six_volumes(mesh) < 0) return "the faces look inwards";
  if (p.grown.only_flaps) return "walls without thickness had to be grown";
  if (p.grown && (is_needle(p) || wants_lengths(p.options) || !has_room_for_parts(p.target_of_input.vertices, input)))
    return "walls had to be grown";
  if (!p.grown ? p.closing_vox > 0 : p.options.closing_vox.value_or(0) > 0 || p.options.closing_world.value_or(0) > 0)
    return "gaps were closed";
  if (p.own_faces_meet) return "faces are so narrow that they meet once they are rounded";
  return "";
}

/// The mesh once every fan of triangles has a vertex of its own, as in the result.
struct SeparatedMesh {
  int64_t more_places = 0;  ///< vertices of the result that are at places of others
  int64_t border_loops = 0;
};
SeparatedMesh separated(const FeatureMesh& mesh, const CurveNetwork& network) {
  TriangleMesh apart;
  apart.vertices = mesh.vertices;
  apart.triangles = mesh.triangles;
  const bool is_other = !separate_fans(apart.vertices, apart.triangles).empty();
  const bool has_borders = count_kind(network, CurveKind::border) + count_kind(network, CurveKind::non_manifold) > 0;
  return {is_other ? count_separated_places(mesh, network, apart.triangles) : 0,
          has_borders ? check_mesh(apart).boundary_loops : 0};
}

/// The borders of the sheet are no part of a surface that is open, nor what was grown of one that is not.
int64_t vertices_of(const PreparedSurface& p, bool is_open) {
  return (is_open && !p.vertices_of_lengths) || p.grown ? p.target_of_input.vertices : p.target.vertices;
}

/// An estimate with the fine surface, which has about 21 vertices a seed. Throws: NoRoom where that is above the limit.
void add_memory_of_cut(int64_t seeds, Run& run) {
  constexpr int64_t kBytesPerSeed = 21 * 350;
  const int64_t bytes = run.memory_estimate_bytes + kBytesPerSeed * seeds, limit = run.context.memory_limit_bytes;
  if (limit > 0 && bytes > limit)
    throw NoRoom("features", "the surface cut along them would take about " + std::to_string(bytes >> 20) +
                                 " MiB, more than the limit of " + std::to_string(limit >> 20) +
                                 "; raise --max-memory, or ask for fewer vertices");
  run.memory_estimate_bytes = bytes;
}

std::vector<uint64_t> edges_of(const FeatureCurve& curve) {
  std::vector<uint64_t> edges;
  append_edges(curve, edges);
  return edges;
}

std::vector<uint64_t> edges_of(const CurveNetwork& network) {
  std::vector<uint64_t> all;
  for (const FeatureCurve& curve : network.curves) append_edges(curve, all);
  std::sort(all.begin(), all.end());
  return all;
}

/// The curves of a network of which less than half is among some edges.
std::vector<LostCurve> left_out_of(const FeatureMesh& mesh, const CurveNetwork& network,
                                   const std::vector<uint64_t>& kept) {
  std::vector<LostCurve> out;
  const std::vector<LostCurve> all = describe(mesh, network);
  for (size_t c = 0; c < all.size(); ++c) {
    const std::vector<uint64_t> edges = edges_of(network.curves[c]);
    const auto held = std::count_if(edges.begin(), edges.end(),
                                    [&](uint64_t e) { return std::binary_search(kept.begin(), kept.end(), e); });
    if (2 * size_t(held) >= edges.size()) continue;
    out.push_back(all[c]);
    out.back().reason = kEdgesTooLong;
  }
  return out;
}

/// What is to be cut, and how.
struct CutPlan {
  const FeatureMesh& mesh;
  const CurveOptions& curves;
  const FoundCreases& creases;
  const LatticeFrame& frame;
  int64_t seeds;  ///< of a surface whose lengths do not decide
  bool needs_curves;
  CutOptions how = {};
};

/// Lengths are such that triangles fill the area with the number of vertices, but corners and short curves between them
/// may take more than that. Then all lengths are longer, as much as it takes for curves and the patches between them to
/// share the vertices evenly, or as near as some cuts come: at first a vertex fewer by length is taken to be one fewer
/// of the result, then as many as it was last. Throws: NoRoom where they would be too long.
std::shared_ptr<CutSurface> cut_evenly(const CutPlan& plan, const CurveNetwork& network, Context& context) {
  CutOptions how = plan.how;
  const int64_t vertices = how.vertices, fewest = std::llround(std::ceil(kFewestByLength * double(vertices)));
  double before = 0, gone = 0;  // the surplus of the cut before, and by how many vertices that was cut for more
  for (int cuts = 1;; ++cuts) {
    auto cut = std::make_shared<CutSurface>(cut_surface(plan.mesh, network, plan.frame, how, context));
    if (vertices == 0) return cut;
    cut->seeds = vertices;
    const double surplus = FreeSeeds(*cut).by_length(seeds_on_curves(*cut, 0)) - double(vertices);
    if (surplus <= kMoreThanAsked * double(vertices)) return cut;
    if (how.vertices == fewest)
      throw NoRoom("features", "curves, and the patches between them, take more than " + std::to_string(cut->seeds) +
                                   " vertices; use more vertices, or a higher angle from which on edges are features");
    if (cuts == kMostCuts) return cut;
    const double rate = cuts == 1 ? 1 : std::min((before - surplus) / gone, 1.);
    const auto most = double(how.vertices - fewest);
    before = surplus;
    gone = rate > 0 ? std::min(std::ceil(surplus / rate), most) : most;
    how.vertices -= int64_t(gone);
    how.edge_length_world = edge_length_for(plan.mesh, network, how.vertices);
  }
}

/// Throws: NoRoom where the network has no curve left: the mesh is made on the sheet then, and homes of seeds that were
/// relaxed here would be no vertices of that.
CutAlongCurves make_cut(const CutPlan& plan, const CurveNetwork& network, CutSource source, FeatureReport found,
                        Context& context) {
  if (plan.needs_curves && network.curves.empty())
    throw NoRoom("features", "edges are too long for that; use more vertices, or a shorter edge length");
  const std::shared_ptr<CutSurface> cut = cut_evenly(plan, network, context);
  if (cut->seeds == 0) cut->seeds = plan.seeds;
  const SeedSet fixed = seeds_on_curves(*cut, 0);
  FreeSeeds(*cut).counts(fixed, cut->seeds);  // there is room
  found.vertices = count_places(fixed.fixed);
  found.patches = int64_t(patch_count(*cut));
  found.given_up.clear();
  cut->source = std::make_shared<const CutSource>(std::move(source));
  return {cut, std::move(found)};
}

/// The same along as many creases as half of the vertices can hold, to within a tenth or as near as some looks come.
/// Throws: as make_cut, at the first look.
CutAlongCurves cut_along_fewer(const CutPlan& plan, const CurveNetwork& all, const CutSource& source,
                               const FeatureReport& all_found, Context& context) {
  const FeatureMesh& mesh = plan.mesh;
  const double most = std::max(1., (1 - kFewestByLength) * double(plan.seeds));
  CurveOptions within_budget = plan.curves;
  within_budget.edge_length_world = plan.how.edge_length_world / std::sqrt(kFewestByLength);
  within_budget.most_vertices = most;
  CutAlongCurves cut;
  std::vector<uint64_t> kept_before;
  for (int look = 1; look <= kMostLooks; ++look) {
    const CurveNetwork network = find_curves(mesh, within_budget, plan.creases);
    const std::vector<uint64_t> kept = edges_of(network);
    if (cut.surface && kept == kept_before) break;
    kept_before = kept;
    CutSource fewer = source;
    fewer.found = describe(mesh, network);
    for (LostCurve& curve : left_out_of(mesh, all, kept)) fewer.left_out.push_back(std::move(curve));
    FeatureReport found = all_found;
    report_found(mesh, network, all_found.border_loops > 0, found);
    found.border_loops = all_found.border_loops;
    found.length_world = all_found.length_world;
    const auto make = [&] {
      cut = make_cut(plan, network, std::move(fewer), std::move(found), context);
      return std::string();
    };
    const bool is_last = look == kMostLooks;
    if (is_last && !cut.surface)
      make();
    else if (!failure_reason(make).empty() && cut.surface)
      break;  // what was cut before stays
    const auto vertices = double(cut.features.vertices);
    if (cut.surface && vertices <= kNearMost * most) break;
    within_budget.most_vertices *= cut.surface ? most / vertices : 1 - kFewestByLength;
  }
  return cut;
}

/// How many vertices curves take at least at edges of that length: they are shorter where curves bend, or face others.
double least_vertices_on(const CurveNetwork& network, const std::vector<LostCurve>& curves, double edge_length_world) {
  double sum = double(network.corners.size());
  for (const LostCurve& curve : curves) sum += std::max(0., curve.length_world / edge_length_world - 1);
  return sum;
}

/// Cuts a mesh along its curves, or along fewer where these take too many of the vertices. Throws: NoRoom where there
/// is no room for borders, seams and lines.
CutAlongCurves cut_network(const FeatureMesh& mesh, const CurveNetwork& network, const CurveOptions& curves,
                           const FoundCreases& creases, const CutSource& source, int64_t seeds,
                           const PreviousFrame* before, const PreparedSurface& p, const FeatureReport& found,
                           Run& run) {
  CutPlan plan{mesh, curves, creases, p.surface.frame, seeds, !p.needs_own_triangles};
  add_memory_of_cut(seeds, run);
  CutOptions& how = plan.how;
  how = {edge_length_for(mesh, network, seeds), 0,
         requested_lengths(p, !p.sheet.lengths.at.empty(), p.target_of_input.edge_length_world)};
  if (before) how.before = before->carried;
  const bool lengths_decide = how.requested.vary() && field_decides(p.options);
  if (!lengths_decide && (how.requested.vary() || curves.mode != CreaseMode::off)) how.vertices = seeds;
  CutAlongCurves cut;
  const auto cut_along_all = [&] {
    failure_reason([&] {
      cut = make_cut(plan, network, source, found, run.context);
      return std::string();
    });
  };
  const double longest_world = how.edge_length_world / std::sqrt(kFewestByLength);
  const bool may_fit = how.vertices == 0 || least_vertices_on(network, source.found, longest_world) <= double(seeds);
  if (may_fit) cut_along_all();
  if (!cut.surface && !how.before.empty()) {  // curves may keep more seeds than there is room for
    how.before.clear();
    if (may_fit) cut_along_all();
  }
  if (cut.surface) return cut;
  return cut_along_fewer(plan, network, source, found, run.context);
}

/// Those of which less than half was laid onto the sheet.
std::vector<LostCurve> not_laid(const std::vector<LostCurve>& curves, const std::vector<double>& laid_world) {
  std::vector<LostCurve> lost;
  for (size_t c = 0; c < curves.size(); ++c) {
    const bool is_wanted =
        curves[c].kind != name_of(CurveKind::border) && curves[c].kind != name_of(CurveKind::non_manifold);
    if (!is_wanted || 2 * laid_world[c] >= curves[c].length_world) continue;
    lost.push_back(curves[c]);
    lost.back().reason = "the result does not pass there";
  }
  return lost;
}

/// Of each curve on the sheet the number of the one that was laid there.
void name_as_laid(const LaidCurves& laid, const CurveNetwork& on_sheet, std::vector<LostCurve>& curves) {
  std::unordered_map<uint64_t, uint32_t> curve_of;
  for (const LaidPiece& piece : laid.pieces)
    for (const auto& [a, b] : piece.edges) curve_of.emplace(edge_key(a, b), piece.curve);
  for (size_t c = 0; c < curves.size(); ++c) {
    const auto found = curve_of.find(edges_of(on_sheet.curves[c]).front());
    if (found != curve_of.end()) curves[c].index = found->second;
  }
}

/// Cuts the sheet along the curves of a mesh that cannot be cut itself, for the reason given. No surface where none of
/// them is near it. Throws: NoRoom.
CutAlongCurves cut_sheet(const FeatureMesh& mesh, const CurveNetwork& network, double edge_length_world,
                         const std::string& against, const PreviousFrame* before, const PreparedSurface& p,
                         FeatureReport found, Run& run) {
  if (!has_sheet(p)) return {};
  if (p.grown && !p.grown.only_flaps)  // the sheet is beside the surface everywhere
    return {};
  const LaidCurves laid = lay_on_sheet(mesh, network, p, run.context);
  CurveOptions given;
  given.mode = CreaseMode::given;
  given.edge_length_world = edge_length_world;
  given.creases = laid.creases;
  given.seams = laid.seams;
  given.lines = laid.lines;
  const FoundCreases creases = find_creases(laid.mesh, given);
  const CurveNetwork on_sheet = find_curves(laid.mesh, given, creases);
  if (on_sheet.curves.empty()) return {};
  const std::vector<LostCurve> all = describe(mesh, network);
  CutSource source{all, describe(laid.mesh, on_sheet), not_laid(all, laid.lengths_world(all.size())), true};
  name_as_laid(laid, on_sheet, source.found);
  found.on_sheet = against;
  return cut_network(laid.mesh, on_sheet, given, creases, source, p.target.vertices, before, p, found, run);
}

}  // namespace

/// Of a surface that the options leave open.
bool may_keep_borders(const PreparedSurface& p) {
  return p.options.boundary == Boundary::keep && !p.surface.topology.closed;
}

bool cut_along(const FeatureMesh& mesh, const CurveOptions& curves, std::optional<FoundCreases> known,
               PreparedSurface& p, Run& run) {
  Context& context = run.context;
  CreaseReport creases;
  FeatureReport& found = p.report.features;
  std::vector<LostCurve> all;
  const std::string why = failure_reason([&]() -> std::string {
    if (!known) known = run_with_threads(context, [&] { return find_creases(mesh, curves); });
    const CurveNetwork network = run_with_threads(context, [&] { return find_curves(mesh, curves, *known, &creases); });
    const bool is_open = count_kind(network, CurveKind::border) > 0 && may_keep_borders(p);
    report_found(mesh, network, is_open, found);
    warn_of_branches(mesh, network, run.warnings);
    found.passed_over_world = std::max(0., creases.candidate_length_world - creases.kept_length_world);
    if (found.curves == 0 && !is_open && !p.needs_own_triangles) return "";
    all = describe(mesh, network);
    const std::string against = is_open ? obstacle_to_borders(network) : obstacle(p, mesh, network);
    if (!against.empty() && is_open) return against;
    if (!against.empty() && p.needs_own_triangles) return against;
    CutAlongCurves cut;
    if (!against.empty()) {
      cut = cut_sheet(mesh, network, curves.edge_length_world, against, p.previous.get(), p, found, run);
      if (!cut.surface) return against;
    } else {
      const SeparatedMesh apart = separated(mesh, network);
      found.border_loops = apart.border_loops;
      CutSource source{all, all, {}};
      cut = cut_network(mesh, network, curves, *known, source, vertices_of(p, is_open) - apart.more_places,
                        p.previous.get(), p, found, run);
    }
    p.cut = std::move(cut.surface);
    found = std::move(cut.features);
    return "";
  });
  if (!why.empty()) give_up(all, why, found, run);
  return why.empty();
}

}  // namespace isoshell
