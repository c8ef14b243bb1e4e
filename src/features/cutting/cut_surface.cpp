// cut_surface and edge_length_for (see cut_surface.h).
#include "features/cutting/cut_surface.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/watched.h"
#include "features/cutting/cut_fine_mesh.h"
#include "features/mesh/flip_flat_edges.h"
#include "features/mesh/refine_mesh.h"
#include "features/seeds/edge_lengths.h"
#include "features/seeds/path_seeds.h"
#include "features/seeds/tied_paths.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr double kFacingReach = 0.9;  ///< of curves that see one another, in edge lengths
constexpr double kFirstCut = 1.5;     ///< lengths of the mesh on which they are found, over the one that is asked for
constexpr int kMostCuts = 3;          ///< until the fine mesh shows the lengths that are asked for

/// As snap_coordinate, before it rounds.
WorldPoint on_lattice(const LatticeFrame& frame, const WorldPoint& p) {
  const auto steps = [&](double world, double origin) { return (world - origin) / frame.voxel_size * kOneVoxelQ8; };
  return {steps(p.x, frame.origin.x), steps(p.y, frame.origin.y), steps(p.z, frame.origin.z)};
}

/// With the lengths that are asked for, and cut again where these are so short that it shows too little of them.
VertexGraph with_asked_lengths(FineMesh& fine, const LatticeFrame& frame, const CutOptions& options, Context& context) {
  const double e = fine.edge_length[0];
  for (int cut = 1;; ++cut) {
    VertexGraph graph = find_vertex_graph(fine);
    if (!options.requested.vary()) return graph;
    const size_t before = fine.position.size();
    ask_for_lengths(fine, graph, frame, options.requested, options.vertices, e);
    if (cut == kMostCuts) return graph;
    FineMesh finer = fine;
    for (double& l : finer.edge_length) l = std::min(2 * l, e);
    finer = refine_mesh(std::move(finer), context);
    if (finer.position.size() == before) return graph;
    fine = std::move(finer);
  }
}

/// Edges that have not two triangles in one plane: keys, ascending.
std::vector<uint64_t> turning_edges(const FineMesh& mesh) {
  const auto at = [&](uint32_t h) { return mesh.position[mesh.triangles[h / 3][h % 3]]; };
  std::vector<uint64_t> edges;
  for_each_edge(find_edge_sides(mesh.triangles, mesh.position.size()),
                [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
                  if (on_edge.size == 2) {
                    const uint32_t h = on_edge[0].half_edge, twin = on_edge[1].half_edge;
                    const uint32_t next = next_in_triangle(h), opposite = next_in_triangle(next);
                    if (are_in_plane(at(h), at(next), at(opposite), at(next_in_triangle(next_in_triangle(twin)))))
                      return;
                  }
                  edges.push_back(edge_key(u, v));
                });
  return edges;
}

/// With the edges cut at which the surface turns, and triangles in planes Delaunay after that. Of the long thin
/// triangles of flat faces the parts would have vertices nearer to one another than the lattice can tell.
FineMesh without_slivers(FineMesh mesh, Context& context) {
  const std::vector<uint64_t> turning = turning_edges(mesh);
  return flip_flat_edges(refine_mesh(std::move(mesh), context, &turning));
}

/// Cut coarsely first, to find the lengths, then as they ask, with a vertex for every seed of a path.
FineMesh refined(const FeatureMesh& mesh, const CurveNetwork& network, const LatticeFrame& frame,
                 const CutOptions& options, Context& context, MeshTwins& twins) {
  FineMesh fine;
  for (const WorldPoint& p : mesh.vertices) fine.position.push_back(on_lattice(frame, p));
  const double e = options.edge_length_world / frame.voxel_size * kOneVoxelQ8;
  fine.edge_length.assign(fine.position.size(), kFirstCut * e);
  fine.triangles = mesh.triangles;
  fine.source_face = mesh.source_face;
  if (options.is_rough) fine.parts_of_edge = kPartsOfRoughEdge;
  fine.paths = curve_paths(fine.position, fine.triangles, network);
  find_jagged_paths(fine.position, e, fine.paths);
  if (!options.is_rough) fine = without_slivers(std::move(fine), context);
  fine = refine_mesh(std::move(fine), context);
  std::fill(fine.edge_length.begin(), fine.edge_length.end(), e);
  const VertexGraph graph = with_asked_lengths(fine, frame, options, context);
  const double widest = *std::max_element(fine.edge_length.begin(), fine.edge_length.end());
  const std::vector<FacingVertices> facing = find_facing_vertices(fine, graph, kFacingReach * widest);
  if (options.vertices > 0 || options.requested.vary())
    vary_edge_lengths(fine, graph, facing,
                      {options.vertices, options.requested.growth, options.requested.are_places(), options.is_rough});
  const TiedPaths tied(fine, (kOneVoxelQ8 / frame.voxel_size) * options.period_world);
  tied.share_lengths(fine);
  check_cancel(context, "features");
  std::vector<WorldPoint> before;
  for (const WorldPoint& p : options.before) before.push_back(on_lattice(frame, p));
  place_path_seeds(fine, facing, before);
  tied.share_seeds(fine);
  fine = refine_mesh(std::move(fine), context);
  begin_loops_at_seeds(fine);
  return flip_flat_edges(std::move(fine), &twins);
}

void require_edge_length(double edge_length_world) {
  if (edge_length_world > 0 && std::isfinite(edge_length_world)) return;
  throw Error(ErrorCode::usage, "features",
              "the edge length is " + std::to_string(edge_length_world) + "; it must be above 0, and finite");
}

}  // namespace

CutSurface cut_surface(const FeatureMesh& mesh, const CurveNetwork& network, const LatticeFrame& frame,
                       const CutOptions& options, Context& context) {
  require_edge_length(options.edge_length_world);
  auto fine = std::make_shared<FineMesh>();
  MeshTwins twins;
  run_with_threads(context, [&] { *fine = refined(mesh, network, frame, options, context, twins); });
  CutSurface cut = cut_fine_mesh(fine, frame, context, std::move(twins));
  cut.is_requested = options.requested.vary();
  cut.seeds = options.vertices;
  if (cut.seeds == 0 && cut.is_requested) cut.seeds = std::llround(vertices_of_lengths(*fine));
  return cut;
}

std::vector<std::array<int32_t, 2>> labels_of_patches(const CutSurface& cut) {
  std::vector<std::array<int32_t, 2>> labels(patch_count(cut), {0, 0});
  for (size_t t = 0; t < cut.fine->triangles.size(); ++t)
    labels[cut.surface.patch[cut.corner[3 * t]]] = cut.regions->labels[cut.fine->source_face[t]];
  return labels;
}

double edge_length_for(const FeatureMesh& mesh, const CurveNetwork& network, int64_t vertices) {
  if (vertices < 1)
    throw Error(ErrorCode::usage, "features", std::to_string(vertices) + " vertices are too few; it takes at least 1");
  double area = 0, extra = 0;
  for (const auto& t : mesh.triangles)
    area += triangle_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  for (const FeatureCurve& curve : network.curves) {
    const double sign = curve.kind == CurveKind::border ? 1 : curve.kind == CurveKind::non_manifold ? -1 : 0;
    if (sign != 0) extra += sign * length_of(mesh.vertices, curve) / 2;
  }
  // vertices = 2 / sqrt(3) * area / e^2 + extra / e, solved for 1 / e.
  const double per_area = 2 / std::sqrt(3.0) * area;
  return 2 * per_area / (std::sqrt(extra * extra + 4 * per_area * double(vertices)) - extra);
}

}  // namespace isoshell
