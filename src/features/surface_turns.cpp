// surface_turns and limit_by_surface_turns (see length_limits.h).
#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/world_vector.h"
#include "features/length_limits.h"

namespace isoshell {
namespace {

using Normal64 = std::array<int64_t, 3>;
constexpr double kUnit = 1 << 20;
constexpr int kMostRounds = 32;

WorldPoint to_point(const Normal64& n) { return {double(n[0]), double(n[1]), double(n[2])}; }
Normal64 with_length(const WorldPoint& n, double l) {
  const double scale = length(n) > 0 ? l / length(n) : 0;
  return {std::llround(n.x * scale), std::llround(n.y * scale), std::llround(n.z * scale)};
}

/// Of unit length, off paths; 0 on them.
std::vector<Normal64> vertex_normals(const FineMesh& mesh, const std::vector<char>& is_on_path) {
  std::vector<Normal64> normal(mesh.position.size(), Normal64{});
  for (const auto& t : mesh.triangles) {
    const WorldPoint n = doubled_area(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]);
    const Normal64 whole = {std::llround(n.x), std::llround(n.y), std::llround(n.z)};
    for (const uint32_t v : t)
      for (size_t k = 0; k < 3; ++k) normal[v][k] += whole[k];
  }
  for (size_t v = 0; v < normal.size(); ++v)
    normal[v] = is_on_path[v] ? Normal64{} : with_length(to_point(normal[v]), kUnit);
  return normal;
}

/// Each round spreads them by half an edge squared.
int rounds_for(const FineMesh& mesh, const VertexGraph& graph, double e) {
  int64_t sum = 0;
  for (size_t v = 0; v + 1 < graph.first.size(); ++v)
    for (int64_t i = graph.first[v]; i < graph.first[v + 1]; ++i)
      sum += std::llround(distance_sq(mesh.position[v], mesh.position[graph.neighbour[size_t(i)]]));
  const double mean_sq = double(sum) / double(std::max<size_t>(1, graph.neighbour.size()));
  return int(std::clamp(std::ceil(e * e / 2 / std::max(mean_sq, 1.0)), 1.0, double(kMostRounds)));
}

}  // namespace

std::vector<double> surface_turns(const FineMesh& mesh, const VertexGraph& graph, double e) {
  std::vector<double> turn(mesh.position.size(), 0);
  std::vector<char> is_on_path(mesh.position.size(), 0);
  for (const CurvePath& path : mesh.paths)
    for (const uint32_t v : path.vertex) is_on_path[v] = 1;
  std::vector<Normal64> normal = vertex_normals(mesh, is_on_path), next = normal;
  const auto for_neighbours = [&](size_t v, auto&& visit) {
    for (int64_t i = graph.first[v]; i < graph.first[v + 1]; ++i)
      if (!is_on_path[graph.neighbour[size_t(i)]]) visit(graph.neighbour[size_t(i)]);
  };
  for (int round = rounds_for(mesh, graph, e); round > 0; --round) {
    tbb::parallel_for(size_t(0), normal.size(), [&](size_t v) {
      if (is_on_path[v]) return;
      Normal64 sum{};
      int64_t count = 0;
      for_neighbours(v, [&](uint32_t u) {
        for (size_t k = 0; k < 3; ++k) sum[k] += normal[u][k];
        ++count;
      });
      for (size_t k = 0; k < 3; ++k)
        next[v][k] = count > 0 ? (normal[v][k] * count + sum[k]) / (2 * count) : normal[v][k];
    });
    normal.swap(next);
  }
  tbb::parallel_for(size_t(0), normal.size(), [&](size_t v) { next[v] = with_length(to_point(normal[v]), kUnit); });
  tbb::parallel_for(size_t(0), normal.size(), [&](size_t v) {
    if (is_on_path[v]) return;
    int64_t sum = 0, count = 0;
    for_neighbours(v, [&](uint32_t u) {
      const double apart_sq = std::max(distance_sq(mesh.position[v], mesh.position[u]), e * e / 16);
      sum +=
          std::llround(kUnit * e * e * length_sq(to_point(next[u]) - to_point(next[v])) / (kUnit * kUnit) / apart_sq);
      ++count;
    });
    if (count == 0) return;
    turn[v] = std::sqrt(2 * double(sum) / (kUnit * double(count)));
  });
  return turn;
}

void limit_by_surface_turns(const FineMesh& mesh, const VertexGraph& graph, double e, std::vector<double>& limit) {
  const std::vector<double> turn = surface_turns(mesh, graph, e);
  for (size_t v = 0; v < turn.size(); ++v)
    if (turn[v] > kEdgeOfRadius) limit[v] = std::min(limit[v], kEdgeOfRadius * e / turn[v]);
}

}  // namespace isoshell
