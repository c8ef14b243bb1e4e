// See edge_lengths.h.
#include "features/seeds/edge_lengths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/parallel_ranges.h"
#include "features/seeds/length_limits.h"
#include "features/seeds/path_seeds.h"
#include "features/seeds/requested_lengths.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kShortest = 0.25;  ///< over what is asked for
constexpr double kEdgeOfGap = 1.5;  ///< longest edge along a strip over its width
constexpr int kRounds = 8;          ///< that find the longest length, each a search over the mesh
constexpr double kCloseEnough = 0.005;
constexpr double kLeastStep = 0.6;  ///< from one longest length to the next

/// How long edges may be: at each vertex, and over those around it.
struct Limits {
  std::vector<double> requested;  ///< per vertex, over the longest
  std::vector<double> most;       ///< per vertex, whatever the longest is
  double growth;                  ///< of a length along the way
};

/// The lengths asked for within the limits, and less where a shorter length is near.
std::vector<double> graded(const VertexGraph& graph, const Limits& limits, double longest) {
  std::vector<double> own(limits.most.size());
  for_each_index(size_t(0), own.size(), [&](size_t v) {
    const double requested = limits.requested[v] * longest;
    own[v] = std::clamp(limits.most[v], std::max(kShortest * requested, longest / kMostLengthRatio), requested);
  });
  return least_values(graph, own, [&](double length, double way) { return length + limits.growth * way; });
}

/// On paths, by their own lengths.
void limit_by_path_lengths(const std::vector<CurvePath>& paths, std::vector<double>& limit) {
  for (const CurvePath& path : paths)
    for (const uint32_t v : path.vertex) limit[v] = std::min(limit[v], path.length / double(path.least_segments));
}

/// Beside strips between two curves, or two parts of one, by their width.
void limit_by_gaps(const std::vector<FacingVertices>& facing, double e, std::vector<double>& limit) {
  for (const FacingVertices& f : facing) {
    if (f.gap * kEdgeOfGap >= e) continue;
    for (const uint32_t w : {f.middle[0], f.middle[1], f.on_path[0], f.on_path[1]})
      limit[w] = std::min(limit[w], kEdgeOfGap * f.gap);
  }
}

/// By turns as edges of the length asked for see them, unless these are no bends: each vertex takes those within a
/// length that is at most twice its own. And by lengths of paths, and gaps.
std::vector<double> most_lengths(const FineMesh& mesh, const VertexGraph& graph,
                                 const std::vector<FacingVertices>& facing, bool is_rough) {
  const auto [least, widest] = std::minmax_element(mesh.edge_length.begin(), mesh.edge_length.end());
  std::vector<double> most(mesh.position.size(), 2 * *widest);
  for (double e = *widest; !is_rough; e /= 2) {
    std::vector<double> here(mesh.position.size(), 2 * *widest);
    limit_by_curve_turns(mesh.position, mesh.paths, e, here);
    limit_by_surface_turns(mesh, graph, e, here);
    for (size_t v = 0; v < here.size(); ++v)
      if (mesh.edge_length[v] <= e) most[v] = here[v];
    if (*least > e / 2) break;
  }
  limit_by_path_lengths(mesh.paths, most);
  limit_by_gaps(facing, *widest, most);
  return most;
}

}  // namespace

double vertices_of_lengths(const FineMesh& mesh) {
  const auto vertices_q20 = [&](const std::array<uint32_t, 3>& t) {
    const double l = (mesh.edge_length[t[0]] + mesh.edge_length[t[1]] + mesh.edge_length[t[2]]) / 3;
    const double area = triangle_area(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]);
    return int64_t(std::llround(2 / std::sqrt(3.0) * area / (l * l) * (1 << 20)));
  };
  // No order of triangles shows in a sum of integers.
  const int64_t triangles_q20 = sum_over_ranges(int64_t(mesh.triangles.size()), 4096, [&](int64_t begin, int64_t end) {
    int64_t sum = 0;
    for (int64_t t = begin; t < end; ++t) sum += vertices_q20(mesh.triangles[size_t(t)]);
    return sum;
  });
  double sum = double(triangles_q20) / (1 << 20);
  for (const CurvePath& path : mesh.paths) {
    const double each = path.kind == CurveKind::border ? 0.5 : path.kind == CurveKind::non_manifold ? -0.5 : 0;
    if (each != 0) sum += each * segments_along(mesh, path).back();
  }
  return sum;
}

void vary_edge_lengths(FineMesh& mesh, const VertexGraph& graph, const std::vector<FacingVertices>& facing,
                       const LengthOptions& options) {
  const auto [least, widest] = std::minmax_element(mesh.edge_length.begin(), mesh.edge_length.end());
  const double e = *widest;
  const bool is_even = *least == e;
  Limits limits{mesh.edge_length, std::vector<double>(mesh.position.size(), kMostLengthRatio * e), options.growth};
  if (!options.as_requested) limits.most = most_lengths(mesh, graph, facing, options.is_rough);
  if (is_even && std::all_of(limits.most.begin(), limits.most.end(), [&](double l) { return l >= e; })) return;
  for (double& requested : limits.requested) requested /= e;
  if (options.vertices == 0) {
    mesh.edge_length = graded(graph, limits, e);
    return;
  }
  // The root of the density of vertices, and so its inverse, is nearly linear in the longest length.
  const double wanted = 1 / std::sqrt(double(options.vertices));
  double longest = e, before = 0, before_reached = 0;
  for (int round = 0; round < kRounds; ++round) {
    mesh.edge_length = graded(graph, limits, longest);
    const double reached = 1 / std::sqrt(vertices_of_lengths(mesh));
    if (std::abs(wanted / reached - 1) < kCloseEnough) return;
    constexpr double kSteep = std::numeric_limits<double>::infinity();  // nothing changed: the largest step
    const double slope = reached != before_reached ? (longest - before) / (reached - before_reached) : kSteep;
    before = longest;
    before_reached = reached;
    longest *= std::clamp(1 + (wanted - reached) * slope / longest, kLeastStep, 1 / kLeastStep);
  }
}

}  // namespace isoshell
