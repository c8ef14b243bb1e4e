// See edge_lengths.h.
#include "features/edge_lengths.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "core/world_vector.h"
#include "features/length_limits.h"
#include "features/path_seeds.h"

namespace isoshell {
namespace {

constexpr double kGrowth = 0.2;     ///< of a length along the way
constexpr double kShortest = 0.25;  ///< over the longest
constexpr int kRounds = 8;          ///< that find the longest length
constexpr double kCloseEnough = 0.005;

/// The limits within bounds, and less where a shorter length is near.
std::vector<double> graded(const FineMesh& mesh, const VertexGraph& graph, const std::vector<double>& limit,
                           double longest) {
  std::vector<double> length(limit.size());
  using Entry = std::pair<double, uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<Entry>> queue;
  for (size_t v = 0; v < limit.size(); ++v) {
    length[v] = std::clamp(limit[v], kShortest * longest, longest);
    if (length[v] < longest) queue.push({length[v], uint32_t(v)});
  }
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

}  // namespace

double vertices_of_lengths(const FineMesh& mesh) {
  int64_t triangles_q20 = 0;  // no order of triangles shows in a sum of integers
  for (const auto& t : mesh.triangles) {
    const double l = (mesh.edge_length[t[0]] + mesh.edge_length[t[1]] + mesh.edge_length[t[2]]) / 3;
    const double area = triangle_area(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]);
    triangles_q20 += std::llround(2 / std::sqrt(3.0) * area / (l * l) * (1 << 20));
  }
  double sum = double(triangles_q20) / (1 << 20);
  for (const CurvePath& path : mesh.paths) {
    const double each = path.kind == CurveKind::border ? 0.5 : path.kind == CurveKind::non_manifold ? -0.5 : 0;
    if (each != 0) sum += each * segments_along(mesh, path).back();
  }
  return sum;
}

void vary_edge_lengths(FineMesh& mesh, int64_t vertices) {
  const double e = mesh.edge_length[0];
  std::vector<double> limit(mesh.position.size(), 2 * e);
  const VertexGraph graph = find_vertex_graph(mesh.triangles, mesh.position.size());
  limit_by_curve_turns(mesh.position, mesh.paths, e, limit);
  limit_by_surface_turns(mesh, graph, e, limit);
  limit_by_gaps(mesh, graph, e, limit);
  if (std::all_of(limit.begin(), limit.end(), [&](double l) { return l >= e; })) return;
  double longest = e;
  for (int round = 0; round < kRounds; ++round) {
    mesh.edge_length = graded(mesh, graph, limit, longest);
    const double factor = std::sqrt(vertices_of_lengths(mesh) / double(vertices));
    if (std::abs(factor - 1) < kCloseEnough) return;
    longest *= factor;
    if (getenv("DBG2")) fprintf(stderr, "longest %.3f e\n", longest / e);
  }
}

}  // namespace isoshell
