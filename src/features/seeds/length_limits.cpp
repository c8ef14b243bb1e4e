// See length_limits.h.
#include "features/seeds/length_limits.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel_ranges.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kUnit = 1 << 20;
constexpr int kMostRounds = 32;

/// As std::llround, without a call.
int64_t whole(double x) {
  const double part = std::trunc(x), rest = x - part;
  return int64_t(part) + (rest >= 0.5 ? 1 : 0) - (rest <= -0.5 ? 1 : 0);
}

/// Of whole numbers, whose sums no order shows in.
WorldPoint with_length(const WorldPoint& n, double l) {
  const double scale = length(n) > 0 ? l / length(n) : 0;
  return {double(whole(n.x * scale)), double(whole(n.y * scale)), double(whole(n.z * scale))};
}
/// As integers divide.
WorldPoint quotient(const WorldPoint& n, double by) {
  return {std::trunc(n.x / by), std::trunc(n.y / by), std::trunc(n.z / by)};
}

/// Of unit length, off paths; 0 on them.
std::vector<WorldPoint> vertex_normals(const FineMesh& mesh, const std::vector<char>& is_on_path) {
  std::vector<std::array<int64_t, 3>> sum(mesh.position.size());
  const bool is_alone = loops_run_alone();
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const WorldPoint n = doubled_area(mesh.position[a], mesh.position[b], mesh.position[c]);
    const std::array<int64_t, 3> here = {whole(n.x), whole(n.y), whole(n.z)};
    for (const uint32_t v : {a, b, c})
      for (size_t k = 0; k < 3; ++k)
        if (is_alone)
          sum[v][k] += here[k];
        else
          atomic_add(sum[v][k], here[k]);
  });
  std::vector<WorldPoint> normal(sum.size(), WorldPoint{0, 0, 0});
  for_each_index(size_t(0), normal.size(), [&](size_t v) {
    if (!is_on_path[v]) normal[v] = with_length({double(sum[v][0]), double(sum[v][1]), double(sum[v][2])}, kUnit);
  });
  return normal;
}

/// Each round spreads them by half an edge squared.
int rounds_for(const FineMesh& mesh, const VertexGraph& graph, double e) {
  const int64_t sum = sum_over_ranges(int64_t(mesh.position.size()), 1024, [&](int64_t begin, int64_t end) {
    int64_t part = 0;
    for (int64_t v = begin; v < end; ++v)
      graph.for_each(
          v, [&](uint32_t u, double) { part += whole(distance_sq(mesh.position[size_t(v)], mesh.position[u])); });
    return part;
  });
  const double mean_sq = double(sum) / double(std::max<int64_t>(1, graph.neighbours.items.size()));
  return int(std::clamp(std::ceil(e * e / 2 / std::max(mean_sq, 1.0)), 1.0, double(kMostRounds)));
}

/// Twice the tangent of half the turn from one direction to the other, along the axis.
WorldPoint turn_tangent(const WorldPoint& before, const WorldPoint& after) {
  constexpr double kLeastCosine = 1e-3;  // above: -1
  const double scale = std::sqrt(length_sq(before) * length_sq(after));
  if (!(scale > 0)) return {};
  return 2 / (scale * std::max(kLeastCosine, 1 + dot(before, after) / scale)) * cross(before, after);
}

/// Sums of turns up to every vertex of a path, twice around a loop.
struct TurnSums {
  std::vector<double> at;
  std::vector<WorldPoint> sum;  ///< one more than `at`: up to, and without, the vertex
};

TurnSums sum_turns(const std::vector<WorldPoint>& position, const CurvePath& path) {
  const size_t n = path.vertex.size(), rounds = path.is_loop ? 3 : 1;
  TurnSums sums;
  sums.sum.push_back({});
  for (size_t i = 0; i < n * rounds; ++i) {
    const size_t k = i % n;
    WorldPoint turn{};
    if (path.is_loop || (k > 0 && k + 1 < n)) {
      const WorldPoint& here = position[path.vertex[k]];
      turn = turn_tangent(here - position[path.vertex[(k + n - 1) % n]], position[path.vertex[(k + 1) % n]] - here);
    }
    sums.at.push_back(path.at[k] + double(i / n) * path.length);
    sums.sum.push_back(sums.sum.back() + turn);
  }
  return sums;
}

}  // namespace

std::vector<double> surface_turns(const FineMesh& mesh, const VertexGraph& graph, double e) {
  std::vector<double> turn(mesh.position.size(), 0);
  std::vector<char> is_on_path(mesh.position.size(), 0);
  for (const CurvePath& path : mesh.paths)
    for (const uint32_t v : path.vertex) is_on_path[v] = 1;
  std::vector<WorldPoint> normal = vertex_normals(mesh, is_on_path), next = normal;
  std::vector<uint32_t> count(normal.size(), 0);  // of neighbours off paths
  for_each_index(size_t(0), normal.size(), [&](size_t v) {
    if (!is_on_path[v]) graph.for_each(int64_t(v), [&](uint32_t u, double) { count[v] += is_on_path[u] ? 0 : 1; });
  });
  // A round changes no normal of a vertex around which the one before changed none: most are in planes.
  const int rounds = rounds_for(mesh, graph, e);
  std::vector<uint8_t> last_round(normal.size(), 1);  // that may change a normal
  for (int round = 1; round <= rounds; ++round) {
    for_each_index(size_t(0), normal.size(), [&](size_t v) {
      if (count[v] == 0 || atomic_load(last_round[v]) < round) return;
      WorldPoint sum = double(count[v]) * normal[v];
      graph.for_each(int64_t(v), [&](uint32_t u, double) { sum = sum + normal[u]; });
      next[v] = quotient(sum, 2 * double(count[v]));
      if (next[v] == normal[v]) return;
      const auto wake = [&](uint32_t u) { __atomic_store_n(&last_round[u], uint8_t(round + 1), __ATOMIC_RELAXED); };
      wake(uint32_t(v));
      graph.for_each(int64_t(v), [&](uint32_t u, double) { wake(u); });
    });
    normal.swap(next);
  }
  for_each_index(size_t(0), normal.size(), [&](size_t v) { next[v] = with_length(normal[v], kUnit); });
  for_each_index(size_t(0), normal.size(), [&](size_t v) {
    if (count[v] == 0) return;
    int64_t sum = 0;
    graph.for_each(int64_t(v), [&](uint32_t u, double) {
      if (is_on_path[u]) return;
      const double apart_sq = std::max(distance_sq(mesh.position[v], mesh.position[u]), e * e / 16);
      sum += whole(kUnit * e * e * length_sq(next[u] - next[v]) / (kUnit * kUnit) / apart_sq);
    });
    turn[v] = std::sqrt(2 * double(sum) / (kUnit * double(count[v])));
  });
  return turn;
}

void limit_by_surface_turns(const FineMesh& mesh, const VertexGraph& graph, double e, std::vector<double>& limit) {
  const std::vector<double> turn = surface_turns(mesh, graph, e);
  for_each_index(size_t(0), turn.size(), [&](size_t v) {
    if (turn[v] > kEdgeOfRadius) limit[v] = std::min(limit[v], kEdgeOfRadius * e / turn[v]);
  });
}

void limit_by_curve_turns(const std::vector<WorldPoint>& position, const std::vector<CurvePath>& paths, double e,
                          std::vector<double>& limit) {
  for (const CurvePath& path : paths) {
    if (path.is_jagged) continue;
    const TurnSums sums = sum_turns(position, path);
    const double width = std::min(e, path.length);
    const double shift = path.is_loop ? path.length : 0;  // the middle one of three rounds
    for (size_t i = 0; i < path.vertex.size(); ++i) {
      double begin = path.at[i] + shift - width / 2;
      if (!path.is_loop) begin = std::clamp(begin, 0.0, path.length - width);
      const auto first = std::lower_bound(sums.at.begin(), sums.at.end(), begin) - sums.at.begin();
      const auto last = std::lower_bound(sums.at.begin(), sums.at.end(), begin + width) - sums.at.begin();
      const double turn = length(sums.sum[size_t(last)] - sums.sum[size_t(first)]);
      double& l = limit[path.vertex[i]];
      if (turn * e > kEdgeOfRadius * width) l = std::min(l, kEdgeOfRadius * width / turn);
    }
  }
}

}  // namespace isoshell
