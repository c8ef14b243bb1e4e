// See patches.h.
#include "pipeline/patches.h"

#include <algorithm>

#include "core/copy_product.h"
#include "core/world_vector.h"
#include "features/curve_seeds.h"
#include "features/cut_surface.h"
#include "features/find_curves.h"
#include "features/weld_for_features.h"
#include "isoshell/distance.h"
#include "isoshell/error.h"
#include "isoshell/mesh_topology.h"
#include "pipeline/choose_grid.h"
#include "pipeline/dual_of_seeds.h"
#include "pipeline/timed.h"

namespace isoshell {
namespace {

CurveOptions curve_options(const RemeshOptions& options, double edge_length_world) {
  const bool automatic = options.features.creases == Features::Creases::automatic;
  return {automatic ? CreaseMode::automatic : CreaseMode::threshold, options.features.degrees, edge_length_world};
}

bool is_crease(const FeatureCurve& curve) { return curve.kind == CurveKind::crease; }

/// Six times the volume inside: below 0 where faces look inwards. Measured from a vertex, for the sake of digits.
double six_volumes(const FeatureMesh& mesh) {
  double sum = 0;
  const WorldPoint& o = mesh.vertices[0];
  for (const auto& t : mesh.triangles)
    sum += dot(mesh.vertices[t[0]] - o, cross(mesh.vertices[t[1]] - o, mesh.vertices[t[2]] - o));
  return sum;
}

/// What keeps the surface from being its own input's triangles; empty where nothing does. Faces that a union cut count
/// as closed whatever their edges are.
std::string obstacle(const Prepared& p, const FeatureMesh& mesh, const CurveNetwork& network) {
  const InputTopology& input = p.surface.topology;
  const bool all_creases = std::all_of(network.curves.begin(), network.curves.end(), is_crease);
  if (!input.closed || !input.oriented || !all_creases)
    return "the surface has holes, edges of more than two faces, or faces that disagree about the outside";
  if (six_volumes(mesh) < 0) return "the faces look inwards";
  if (p.surface.first_cap != kNone) return "holes were capped";
  if (p.grown) return "walls without thickness had to be grown";
  if (p.closing_vox > 0) return "gaps were closed";
  if (!p.sheet.lengths.at.empty()) return "edge lengths vary";
  return "";
}

/// The snapped surface: what a stage file holds, so that a run that resumes finds the same features.
TriangleSoup soup_of(const LatticeSurface& surface) {
  TriangleMesh mesh = to_world(surface);
  TriangleSoup soup;
  soup.vertices = std::move(mesh.vertices);
  soup.triangles = std::move(mesh.triangles);
  return soup;
}

int64_t patches_of(const CutSurface& cut) {
  uint32_t last = 0;
  for (const uint32_t patch : cut.surface.patch) last = std::max(last, patch);
  return int64_t(last) + 1;
}

void give_up(RemeshReport& report, const std::string& why) {
  report.features.given_up = why;
  report.features.patches = report.features.vertices = 0;
  report.warnings.push_back(std::to_string(report.features.curves) + " creases are not kept: " + why);
}

/// What stages refuse as too coarse or too narrow for a curve or patch is no error of the user's: the sheet can do it.
template <class Work>
bool give_up_if_refused(RemeshReport& report, Work work) {
  try {
    work();
    return true;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage) throw;
    give_up(report, error.what());
    return false;
  }
}

/// Throws: usage where they do not fit into the patches.
SeedSet first_seeds(const CutSurface& cut, const SeedOptions& options) {
  return add_free_seeds(cut, seeds_on_curves(cut, cut.edge_length_world), options.count, options.seed);
}

}  // namespace

void cut_into_patches(const RemeshOptions& options, Prepared& p, RemeshReport& report, Context& context) {
  if (options.features.creases == Features::Creases::off) return;
  timed(report, "features", context, [&] {
    const double area_world = p.surface.topology.area_world;
    const int64_t vertices = vertex_target(options, p);
    const FeatureMesh mesh = weld_for_features(soup_of(*OnHost(p.surface)));
    const CurveNetwork network = find_curves(mesh, curve_options(options, usual_edge_length(options, area_world)));
    FeatureReport& found = report.features;
    found.curves = std::count_if(network.curves.begin(), network.curves.end(), is_crease);
    found.corners = int64_t(network.corners.size());
    if (found.curves == 0) return;
    if (const std::string why = obstacle(p, mesh, network); !why.empty()) return give_up(report, why);
    const double edge_world = edge_length_for(mesh, network, vertices);
    give_up_if_refused(report, [&] {
      auto cut = std::make_shared<CutSurface>(cut_surface(mesh, network, p.surface.frame, edge_world, context));
      const SeedSet seeds = first_seeds(*cut, {vertices, options.seed});
      found.vertices = count_places(seeds.fixed);
      found.patches = patches_of(*cut);
      p.cut = std::move(cut);
    });
  });
}

RelaxedSeeds relax_in_patches(const Prepared& p, const SeedOptions& options, const RelaxOptions& relax,
                              Context& context) {
  return relax_on_sheet(p.cut->surface, first_seeds(*p.cut, options), relax, context);
}

std::optional<TriangleMesh> triangulate_patches(const Prepared& p, SeededMesh& made, const OptimizeOptions& options,
                                                RemeshReport& report, Context& context) {
  const CutSurface& cut = *p.cut;
  const int64_t asked = made.seeds.size();
  if (!give_up_if_refused(report, [&] { make_dual_of_seeds(cut.surface, made, report, context); })) return {};
  if (report.dual.failed_cells > 0) {
    give_up(report, std::to_string(report.dual.failed_cells) + " cells beside them are no disks");
    return {};
  }
  if (made.seeds.size() != asked) {
    give_up(report, "the patches take " + std::to_string(made.seeds.size() - asked) + " vertices more");
    return {};
  }
  OptimizedMesh optimized =
      timed(report, "post", context, [&] { return optimize_mesh(cut.surface, std::move(made), options, context); });
  report.post = optimized.report;
  made = std::move(optimized);
  if (report.post.self_intersections > 0) {
    give_up(report, std::to_string(report.post.self_intersections) + " pairs of triangles would intersect");
    return {};
  }
  TriangleMesh mesh = to_world(join_patches(*OnHost(made.mesh), OnHost(made.seeds)->fixed).mesh, p.surface.frame);
  if (!check_mesh(mesh).is_closed_manifold()) {
    give_up(report, "parts that touch in a point or edge would make no manifold");
    return {};
  }
  report.features.kept = report.post_done = true;
  return mesh;
}

}  // namespace isoshell
