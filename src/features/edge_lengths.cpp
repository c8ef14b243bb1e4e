// See edge_lengths.h.
#include "features/edge_lengths.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <queue>

#include "core/world_vector.h"
#include "features/length_limits.h"
#include "features/path_seeds.h"

namespace isoshell {
namespace {

constexpr double kGrowth = 0.2;     ///< of a length along the way
constexpr double kShortest = 0.25;  ///< over the longest
constexpr double kEdgeOfGap = 1.5;  ///< longest edge along a strip over its width
constexpr int kRounds = 8;          ///< that find the longest length, each a search over the mesh
constexpr double kCloseEnough = 0.005;
constexpr double kLeastStep = 0.6;  ///< from one longest length to the next

/// The limits within bounds, and less where a shorter length is near.
std::vector<double> graded(const FineMesh& mesh, const VertexGraph& graph, const std::vector<double>& limit,
                           double longest) {
  std::vector<double> length(limit.size());
  using Entry = std::pair<double, uint32_t>;
  std::vector<Entry> entries;
  for (size_t v = 0; v < limit.size(); ++v) {
    length[v] = std::clamp(limit[v], kShortest * longest, longest);
    if (length[v] < longest) entries.push_back({length[v], uint32_t(v)});
  }
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue({}, std::move(entries));
  while (!queue.empty()) {
    const auto [l, v] = queue.top();
    queue.pop();
    if (l > length[v]) continue;
    for (int64_t i = graph.first[v]; i < graph.first[v + 1]; ++i) {
      const uint32_t u = graph.neighbour[size_t(i)];
      const double most = l + kGrowth * std::sqrt(distance_sq(mesh.position[v], mesh.position[u]));
      if (most >= length[u]) continue;
      length[u] = most;
      queue.push({most, u});
    }
  }
  return length;
}

/// Beside strips between two curves, or two parts of one, by their width.
void limit_by_gaps(const std::vector<FacingVertices>& facing, double e, std::vector<double>& limit) {
  for (const FacingVertices& f : facing) {
    if (f.gap * kEdgeOfGap >= e) continue;
    for (const uint32_t w : {f.middle[0], f.middle[1], f.on_path[0], f.on_path[1]})
      limit[w] = std::min(limit[w], kEdgeOfGap * f.gap);
  }
}

}  // namespace

double vertices_of_lengths(const FineMesh& mesh) {
  const auto vertices_q20 = [&](const std::array<uint32_t, 3>& t) {
    const double l = (mesh.edge_length[t[0]] + mesh.edge_length[t[1]] + mesh.edge_length[t[2]]) / 3;
    const double area = triangle_area(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]);
    return int64_t(std::llround(2 / std::sqrt(3.0) * area / (l * l) * (1 << 20)));
  };
  using Range = tbb::blocked_range<size_t>;
  const int64_t triangles_q20 = tbb::parallel_reduce(  // no order of triangles shows in a sum of integers
      Range(0, mesh.triangles.size(), 4096), int64_t(0),
      [&](const Range& r, int64_t sum) {
        for (size_t t = r.begin(); t < r.end(); ++t) sum += vertices_q20(mesh.triangles[t]);
        return sum;
      },
      std::plus<>());
  double sum = double(triangles_q20) / (1 << 20);
  for (const CurvePath& path : mesh.paths) {
    const double each = path.kind == CurveKind::border ? 0.5 : path.kind == CurveKind::non_manifold ? -0.5 : 0;
    if (each != 0) sum += each * segments_along(mesh, path).back();
  }
  return sum;
}

void vary_edge_lengths(FineMesh& mesh, const VertexGraph& graph, const std::vector<FacingVertices>& facing,
                       int64_t vertices) {
  const double e = mesh.edge_length[0];
  std::vector<double> limit(mesh.position.size(), 2 * e);
  limit_by_curve_turns(mesh.position, mesh.paths, e, limit);
  limit_by_surface_turns(mesh, graph, e, limit);
  limit_by_gaps(facing, e, limit);
  if (std::all_of(limit.begin(), limit.end(), [&](double l) { return l >= e; })) return;
  // The root of the density of vertices, and so its inverse, is nearly linear in the longest length.
  const double wanted = 1 / std::sqrt(double(vertices));
  double longest = e, before = 0, before_reached = 0;
  for (int round = 0; round < kRounds; ++round) {
    mesh.edge_length = graded(mesh, graph, limit, longest);
    const double reached = 1 / std::sqrt(vertices_of_lengths(mesh));
    if (std::abs(wanted / reached - 1) < kCloseEnough) return;
    const double slope = reached != before_reached ? (longest - before) / (reached - before_reached) : 0;
    before = longest;
    before_reached = reached;
    longest *= std::clamp(1 + (wanted - reached) * slope / longest, kLeastStep, 1 / kLeastStep);
  }
}

}  // namespace isoshell
