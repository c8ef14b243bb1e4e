// cut_surface and edge_length_for (see cut_surface.h).
#include "features/cut_surface.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "core/world_vector.h"
#include "features/edge_lengths.h"
#include "features/flip_flat_edges.h"
#include "features/jagged_paths.h"
#include "features/path_seeds.h"
#include "features/refine_mesh.h"
#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {
namespace {

constexpr double kFacingReach = 0.9;  ///< of curves that see one another, in edge lengths
constexpr int kMostCuts = 3;          ///< until the fine mesh shows the lengths that are asked for

/// As snap_coordinate, before it rounds.
WorldPoint on_lattice(const LatticeFrame& frame, const WorldPoint& p) {
  const auto steps = [&](double world, double origin) { return (world - origin) / frame.voxel_size * kOneVoxelQ8; };
  return {steps(p.x, frame.origin.x), steps(p.y, frame.origin.y), steps(p.z, frame.origin.z)};
}
PointQ8 rounded(const WorldPoint& p) {
  const auto nearest = [](double steps) { return int32_t(std::floor(steps + 0.5)); };
  return {nearest(p.x), nearest(p.y), nearest(p.z)};
}

/// With the lengths that are asked for, and cut again where these are so short that it shows too little of them.
VertexGraph with_asked_lengths(FineMesh& fine, const LatticeFrame& frame, const CutOptions& options, Context& context) {
  const double e = fine.edge_length[0];
  for (int cut = 1;; ++cut) {
    VertexGraph graph = find_vertex_graph(fine);
    if (!options.asked.vary()) return graph;
    const size_t before = fine.position.size();
    ask_for_lengths(fine, graph, frame, options.asked, options.vertices, e);
    if (cut == kMostCuts) return graph;
    FineMesh finer = fine;
    for (double& l : finer.edge_length) l = std::min(2 * l, e);
    finer = refine_mesh(std::move(finer), context);
    if (finer.position.size() == before) return graph;
    fine = std::move(finer);
  }
}

/// Cut at the one edge length first, then once more where lengths are less, with a vertex for every seed of a path.
FineMesh refined(const FeatureMesh& mesh, const CurveNetwork& network, const LatticeFrame& frame,
                 const CutOptions& options, Context& context) {
  FineMesh fine;
  for (const WorldPoint& p : mesh.vertices) fine.position.push_back(on_lattice(frame, p));
  fine.edge_length.assign(fine.position.size(), options.edge_length_world / frame.voxel_size * kOneVoxelQ8);
  fine.triangles = mesh.triangles;
  fine.paths = curve_paths(fine.position, fine.triangles, network);
  find_jagged_paths(fine.position, options.edge_length_world / frame.voxel_size * kOneVoxelQ8, fine.paths);
  fine = refine_mesh(std::move(fine), context);
  const VertexGraph graph = with_asked_lengths(fine, frame, options, context);
  const double widest = *std::max_element(fine.edge_length.begin(), fine.edge_length.end());
  const std::vector<FacingVertices> facing = find_facing_vertices(fine, graph, kFacingReach * widest);
  if (options.vertices > 0 || options.asked.vary())
    vary_edge_lengths(fine, graph, facing, {options.vertices, options.asked.growth, options.asked.field != nullptr});
  check_cancel(context, "features");
  place_path_seeds(fine, facing);
  fine = refine_mesh(std::move(fine), context);
  begin_loops_at_seeds(fine);
  return flip_flat_edges(std::move(fine));
}

std::vector<uint64_t> edges_of(const std::vector<CurvePath>& paths) {
  std::vector<uint64_t> edges;
  for (const CurvePath& path : paths)
    for (size_t i = 0; i < path.edge_count(); ++i) edges.push_back(edge_key(path.vertex[i], path.edge_end(i)));
  std::sort(edges.begin(), edges.end());
  return edges;
}

/// Every fan becomes a vertex.
SurfaceTriangles cut_triangles(const FineMesh& mesh, const MeshFans& fans, const LatticeFrame& frame) {
  SurfaceTriangles out;
  std::copy(frame.extent_vox, frame.extent_vox + 3, out.extent_vox);
  out.position.resize(fans.vertex.size());
  out.patch.resize(fans.vertex.size());
  out.triangles.resize(mesh.triangles.size());
  for_each_index(size_t(0), fans.vertex.size(),
                 [&](size_t f) { out.position[f] = rounded(mesh.position[fans.vertex[f]]); });
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t i = 0; i < 3; ++i) out.patch[fans.of_corner[3 * t + i]] = fans.patch[t];
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    const uint32_t* fan = &fans.of_corner[3 * t];
    out.triangles[t] = {fan[0], fan[1], fan[2]};
  });
  return out;
}

/// Numbers the points of the paths. Result: per fine vertex its place, or kNone.
std::vector<uint32_t> number_places(const FineMesh& mesh, CutSurface& cut) {
  std::vector<uint32_t> place(mesh.position.size(), kNone), corners;
  for (const CurvePath& path : mesh.paths)
    if (!path.is_loop) corners.insert(corners.end(), {path.vertex.front(), path.vertex.back()});
  std::sort(corners.begin(), corners.end());
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  uint32_t count = 0;
  for (const uint32_t v : corners) place[v] = count++;
  cut.corner_count = count;
  for (const CurvePath& path : mesh.paths) {
    CutCurve curve{path.curve, path.kind, path.is_loop, {}, path.at, path.length, path.least_segments, {}};
    for (const PathPoint& seed : path.seeds) curve.seeds.push_back(seed.edge);
    for (const uint32_t v : path.vertex) {
      if (place[v] == kNone) place[v] = count++;
      curve.place.push_back(place[v]);
    }
    cut.curves.push_back(std::move(curve));
  }
  return place;
}

/// Which border vertices are at a place.
void list_copies(const MeshFans& fans, const std::vector<uint32_t>& place_of_fine, const std::vector<uint32_t>& number,
                 CutSurface& cut) {
  const SurfaceMesh& surface = cut.surface;
  cut.place.assign(size_t(surface.vertex_count()), kNone);
  if (surface.is_closed()) {
    cut.copies_first = {0};
    return;
  }
  uint32_t places = 0;
  for (const CutCurve& curve : cut.curves)
    for (const uint32_t p : curve.place) places = std::max(places, p + 1);
  cut.copies_first.assign(size_t(places) + 1, 0);
  for (size_t f = 0; f < number.size(); ++f)
    if (surface.border_before[number[f]] != kNone) cut.place[number[f]] = place_of_fine[fans.vertex[f]];
  for (const uint32_t p : cut.place)
    if (p != kNone) ++cut.copies_first[p + 1];
  for (size_t p = 0; p < places; ++p) cut.copies_first[p + 1] += cut.copies_first[p];
  std::vector<int64_t> next(cut.copies_first.begin(), cut.copies_first.end());
  cut.copies.resize(size_t(cut.copies_first.back()));
  for (size_t v = 0; v < cut.place.size(); ++v)
    if (cut.place[v] != kNone) cut.copies[size_t(next[cut.place[v]]++)] = uint32_t(v);
}

/// Gives the surface the lengths, where they vary.
void set_lengths(const FineMesh& mesh, const MeshFans& fans, const std::vector<uint32_t>& number,
                 SurfaceMesh& surface) {
  const auto [least, largest] = std::minmax_element(mesh.edge_length.begin(), mesh.edge_length.end());
  if (*least == *largest) return;
  EdgeLengths& lengths = surface.lengths;
  lengths.at = Buffer<uint32_t>(surface.vertex_count());
  const auto whole = [](double l) { return uint32_t(std::max(1.0, std::floor(l + 0.5))); };
  for (size_t f = 0; f < number.size(); ++f) lengths.at[number[f]] = whole(mesh.edge_length[fans.vertex[f]]);
  lengths.least = whole(*least);
  lengths.largest = whole(*largest);
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
  return run_with_threads(context, [&] {
    const FineMesh fine = refined(mesh, network, frame, options, context);
    const MeshFans fans = find_fans(fine.triangles, int64_t(fine.position.size()), edges_of(fine.paths));
    check_cancel(context, "features");
    CutSurface cut;
    cut.voxel_size = frame.voxel_size;
    cut.is_asked = options.asked.vary();
    cut.seeds = options.vertices;
    if (cut.seeds == 0 && cut.is_asked) cut.seeds = std::llround(vertices_of_lengths(fine));
    MadeSurface made = make_surface_mesh(cut_triangles(fine, fans, frame), context);
    cut.longest_edge_q8 = *std::max_element(fine.edge_length.begin(), fine.edge_length.end());
    cut.surface = std::move(made.surface);
    set_lengths(fine, fans, made.number, cut.surface);
    list_copies(fans, number_places(fine, cut), made.number, cut);
    return cut;
  });
}

double edge_length_for(const FeatureMesh& mesh, const CurveNetwork& network, int64_t vertices) {
  if (vertices < 1)
    throw Error(ErrorCode::usage, "features", std::to_string(vertices) + " vertices are too few; it takes at least 1");
  double area = 0, extra = 0;
  for (const auto& t : mesh.triangles)
    area += triangle_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  for (const FeatureCurve& curve : network.curves) {
    CurvePath path;
    path.vertex = curve.vertex;
    path.is_loop = curve.is_loop;
    measure_path(mesh.vertices, path);
    if (curve.kind == CurveKind::border) extra += path.length / 2;
    if (curve.kind == CurveKind::non_manifold) extra -= path.length / 2;
  }
  // vertices = 2 / sqrt(3) * area / e^2 + extra / e, solved for 1 / e.
  const double per_area = 2 / std::sqrt(3.0) * area;
  return 2 * per_area / (std::sqrt(extra * extra + 4 * per_area * double(vertices)) - extra);
}

}  // namespace isoshell
