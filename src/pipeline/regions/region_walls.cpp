// prepare_regions (see region_walls.h).
#include "pipeline/regions/region_walls.h"

#include <algorithm>
#include <utility>

#include "core/watched.h"
#include "features/curves/tie_corners.h"
#include "features/cutting/curve_seeds.h"
#include "features/cutting/free_seeds.h"
#include "features/mesh/thin_out.h"
#include "features/mesh/weld_for_features.h"
#include "features/walls/near_walls.h"
#include "geometry/wall_pressures.h"
#include "isoshell/error.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/patches/cut_curves.h"
#include "pipeline/patches/feature_report.h"
#include "pipeline/regions/face_seams.h"
#include "pipeline/regions/region_lengths.h"
#include "pipeline/regions/region_memory.h"
#include "pipeline/regions/side_creases.h"
#include "pipeline/sheet/crease_search.h"

namespace isoshell {
namespace {

/// Of relaxed walls of brains with smaller parts, few triangles intersect and few are coarsened; above, cells of
/// hundreds are no disks.
constexpr double kMostNear = 0.11;
constexpr int64_t kManyVertices = 10000;  ///< with fewer it costs little to relax them and see
constexpr int64_t kSmallPatch = 4;        ///< vertices of the result: walls with as few stay as fine as they are

void check_asked_for(const RemeshOptions& options) {
  const auto refuse = [](const char* what) {
    throw Error(ErrorCode::usage, "regions",
                std::string(what) + ": the input parts regions, which are meshed on their walls");
  };
  if (options.method != Method::sheet) refuse("--method shell cannot be used");
  if (options.want_shell) refuse("there is no shell to save");
}

/// Curves there stay the same on opposite sides.
std::vector<uint32_t> vertices_at_periodic_sides(const FeatureMesh& mesh, const FaceRegions& regions) {
  std::vector<uint32_t> found;
  for (size_t t = 0; t < mesh.triangles.size() && regions.is_periodic(); ++t)
    if (regions.is_periodic_side(regions.side[mesh.source_face[t]]))
      found.insert(found.end(), mesh.triangles[t].begin(), mesh.triangles[t].end());
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

/// Both ascending, as is the result, which has what is in any of them.
EdgeList in_any(EdgeList edges, const EdgeList& others) {
  edges.insert(edges.end(), others.begin(), others.end());
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

/// With fewer triangles, where voxels made far more than edges need that are as long everywhere: what follows takes
/// time and memory for each.
FeatureMesh walls_of(const TriangleSoup& soup, const PreparedSurface& p, bool lengths_vary, const Context& context) {
  FeatureMesh mesh = run_with_threads(context, [&] { return weld_for_features(soup); });
  const auto vertices = int64_t(mesh.vertices.size());
  if (lengths_vary || !are_thinned_out(soup, p.target.vertices)) return mesh;
  const double edge_world = edge_length_for(mesh, {}, p.target.vertices);
  const auto fewest = uint32_t(kSmallPatch * vertices / p.target.vertices);
  KeptInWalls kept{side_creases(mesh, soup.regions, edge_world), vertices_at_periodic_sides(mesh, soup.regions)};
  kept.creases = in_any(std::move(kept.creases), face_seams(mesh, soup));
  return thin_out(std::move(mesh), kept, p.surface.frame, edge_world, fewest, context);
}

std::map<int32_t, uint64_t> spanned_volumes(const TriangleSoup& soup, const LatticeFrame& frame) {
  std::map<int32_t, uint64_t> volumes;
  std::vector<PointQ8> at(soup.vertices.size());
  for_each_index(size_t(0), at.size(), [&](size_t v) { at[v] = frame.snap(soup.vertices[v]); });
  for (size_t t = 0; t < soup.triangles.size();) {
    const std::array<int32_t, 2> labels = soup.regions.labels[t];
    uint64_t sum = 0;
    for (; t < soup.triangles.size() && soup.regions.labels[t] == labels; ++t) {
      const auto& [a, b, c] = soup.triangles[t];
      sum += spanned_volume(at[a], at[b], at[c]);
    }
    volumes[labels[0]] += sum;
    volumes[labels[1]] -= sum;
  }
  return volumes;
}

CurveOptions curves_between_regions(const PreparedSurface& p, const TriangleSoup& soup) {
  CurveOptions curves = curve_options(p.options, nullptr, p.target.edge_length_world);
  curves.seams = face_seams(p.walls->mesh, soup);
  if (!p.walls->regions.are_of_voxels) return curves;
  const bool is_periodic = p.walls->regions.is_periodic();
  if (curves.mode != CreaseMode::automatic && !is_periodic) return curves;
  EdgeList at_sides = side_creases(p.walls->mesh, p.walls->regions, curves.edge_length_world);
  if (is_periodic) curves.lines = at_sides;  // all of them, however short they are, whatever was asked for
  if (curves.mode != CreaseMode::automatic) return curves;
  curves.creases = std::move(at_sides);
  curves.mode = curves.creases.empty() ? CreaseMode::off : CreaseMode::given;
  return curves;
}

SharedCut cut_walls(const PreparedSurface& p, const CurveNetwork& network, const std::vector<double>& of_face_world,
                    Run& run) {
  const FeatureMesh& mesh = p.walls->mesh;
  CutOptions how;
  how.edge_length_world = edge_length_for(mesh, network, p.target.vertices);
  how.requested = requested_lengths(p, wants_lengths(p.options), how.edge_length_world);
  how.requested.of_face_world = of_face_world;
  how.is_rough = p.walls->regions.are_of_voxels;
  how.period_world = p.walls->regions.period_world;
  for (std::string& text : warnings_of_bounds(how.requested)) run.warn(std::move(text));
  if (!p.options.edge_length_world && !(how.requested.vary() && field_decides(p.options)))
    how.vertices = p.target.vertices;
  auto cut = std::make_shared<CutSurface>(cut_surface(mesh, network, p.surface.frame, how, run.context));
  const SeedSet fixed = seeds_on_curves(*cut, 0);
  const int64_t wanted = cut->seeds > 0 ? cut->seeds : p.target.vertices;
  cut->seeds = std::max(wanted, FreeSeeds(*cut).fewest(fixed));
  cut->regions = std::shared_ptr<const FaceRegions>(p.walls, &p.walls->regions);
  cut->source = std::make_shared<const CutSource>();
  return cut;
}

}  // namespace

PreparedSurface prepare_regions(const TriangleSoup& soup, const RemeshOptions& options, Run& run) {
  Context& context = run.context;
  check_asked_for(options);
  const SoupTopology measured = run.timed("topology", [&] { return measure_topology(soup, context); });
  const Plan plan = plan_of(options, measured.topology, bounding_box(soup));
  LatticeSurface surface;
  const std::vector<double> of_face_world = lengths_of_faces_world(soup.regions, options.region_edge_lengths);
  surface.frame = frame_of_walls(soup, plan, of_face_world);
  const RunEstimate estimate = estimate_walls(plan, soup, of_face_world, surface.frame);
  require_memory_for_walls(estimate, context);
  run.memory_estimate_bytes = estimate.bytes;
  surface.topology = measured.topology;
  surface.topology.closed = surface.topology.oriented = true;  // as each region's own surface is
  PreparedSurface p = begin_with(std::move(surface), options);
  run.timed("features", [&] {
    auto walls = std::make_shared<RegionWalls>();
    walls->mesh = walls_of(soup, p, wants_lengths(options), context);
    walls->regions = soup.regions;
    if (soup.regions.are_of_voxels)
      walls->spanned_volume_q8 = run_with_threads(context, [&] { return spanned_volumes(soup, p.surface.frame); });
    p.walls = walls;
    CurveNetwork network =
        run_with_threads(context, [&] { return find_curves(p.walls->mesh, curves_between_regions(p, soup)); });
    if (soup.regions.is_periodic()) tie_corners(p.walls->mesh, p.surface.frame, soup.regions.period_world, network);
    report_found(p.walls->mesh, network, false, p.report.features);
    const SharedCut cut = cut_walls(p, network, of_face_world, run);
    if (cut->is_requested && field_decides(p.options)) {
      p.vertices_of_lengths = cut->seeds;
      set_target(p);
    }
    p.report.features.patches = int64_t(patch_count(*cut));
    p.cut = cut;
    if (walls->regions.are_of_voxels && cut->seeds >= kManyVertices)
      walls->are_too_near =
          run_with_threads(context, [&] { return share_of_near_walls(*cut, cut->seeds) > kMostNear; });
  });
  if (options.previous) p.report.coherence.why_cold = "the walls of regions are meshed anew in every frame";
  p.report.input.topology = measured.topology;
  p.report.input.dirt = measured.dirt;
  p.report.grid.frame = p.surface.frame;
  return p;
}

}  // namespace isoshell
