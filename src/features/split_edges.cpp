// SplitEdges (see split_edges.h).
#include "features/split_edges.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <string>
#include <tuple>

#include "core/world_vector.h"
#include "isoshell/error.h"
#include "isoshell/voxel_set.h"

namespace isoshell {
namespace {

/// Inner points of an edge, with the edge length at each.
struct InnerPoints {
  std::vector<WorldPoint> position;
  std::vector<double> edge_length;
};

double longest_between(const FineMesh& mesh, uint32_t u, uint32_t v) {
  return longest_fine_edge((mesh.edge_length[u] + mesh.edge_length[v]) / 2);
}

/// Cuts edge i of a path at its seeds, and between them into equal parts. The next seed of the path is `seed`; where
/// they come to be, counted from the beginning of the edge, is appended to `seed_at`.
InnerPoints cut_path_edge(const FineMesh& mesh, const CurvePath& path, size_t i, size_t& seed,
                          std::vector<size_t>& seed_at) {
  const uint32_t u = path.vertex[i], v = path.edge_end(i);
  const WorldPoint &from = mesh.position[u], &to = mesh.position[v];
  std::vector<double> stops{0};
  for (; seed < path.seeds.size() && path.seeds[seed].edge == i; ++seed)
    if (path.seeds[seed].part > 0)
      stops.push_back(path.seeds[seed].part);
    else
      seed_at.push_back(0);
  stops.push_back(1);
  const auto at = [&](double part) { return part == 1 ? to : from + part * (to - from); };
  const auto length_at = [&](double part) {
    return mesh.edge_length[u] + part * (mesh.edge_length[v] - mesh.edge_length[u]);
  };
  InnerPoints out;
  for (size_t k = 0; k + 1 < stops.size(); ++k) {
    const WorldPoint a = at(stops[k]), b = at(stops[k + 1]);
    const int64_t parts = parts_of(a, b, longest_between(mesh, u, v));
    if (k > 0) seed_at.push_back(out.position.size() + 1);
    for (int64_t j = k > 0 ? 0 : 1; j < parts; ++j) {
      out.position.push_back(point_between(a, b, j, parts));
      out.edge_length.push_back(value_between(length_at(stops[k]), length_at(stops[k + 1]), j, parts));
    }
  }
  return out;
}

/// What path edges are cut into, from the end of the smaller number. Their seeds then are at the vertices that they
/// will have.
std::map<uint64_t, InnerPoints> cut_paths(FineMesh& mesh) {
  std::map<uint64_t, InnerPoints> cut;
  for (CurvePath& path : mesh.paths) {
    std::vector<PathPoint> seeds;
    size_t seed = 0, before = 0;
    for (size_t i = 0; i < path.edge_count(); ++i) {
      const uint32_t u = path.vertex[i], v = path.edge_end(i);
      InnerPoints& points = cut[edge_key(u, v)];
      std::vector<size_t> seed_at;
      points = cut_path_edge(mesh, path, i, seed, seed_at);
      for (const size_t at : seed_at) seeds.push_back({before + at, 0});
      before += points.position.size() + 1;
      if (u < v) continue;  // from the smaller number
      std::reverse(points.position.begin(), points.position.end());
      std::reverse(points.edge_length.begin(), points.edge_length.end());
    }
    if (seed < path.seeds.size()) seeds.push_back({before, 0});
    path.seeds = std::move(seeds);
  }
  return cut;
}

/// Far more than well-shaped triangles of the same area take, and no more than can be numbered or held.
double most_points(const FineMesh& mesh, int64_t memory_bytes) {
  constexpr double kTimesTheNeed = 16, kAlways = 1 << 18, kCountable = kNone / 8;
  constexpr int64_t kBytesPerPoint = 420;  // measured, of the whole run
  double need = double(mesh.triangles.size());
  for (const auto& t : mesh.triangles) {
    const double longest =
        longest_fine_edge((mesh.edge_length[t[0]] + mesh.edge_length[t[1]] + mesh.edge_length[t[2]]) / 3);
    need += triangle_area(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]) / (longest * longest);
  }
  const double held = memory_bytes > 0 ? double(memory_bytes / kBytesPerPoint) : kCountable;
  return std::min({kTimesTheNeed * need + kAlways, kCountable, held});
}

}  // namespace

bool is_before(const WorldPoint& a, const WorldPoint& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

int64_t parts_of(const WorldPoint& a, const WorldPoint& b, double longest) {
  return std::max<int64_t>(1, int64_t(std::ceil(std::sqrt(distance_sq(a, b)) / longest)));
}

WorldPoint point_between(const WorldPoint& a, const WorldPoint& b, int64_t i, int64_t parts) {
  if (is_before(b, a)) return i == parts ? b : b + double(parts - i) / double(parts) * (a - b);
  return i == 0 ? a : a + double(i) / double(parts) * (b - a);
}

double longest_fine_edge(double edge_length) {
  constexpr double kPartsOfEdge = 4, kLongestQ8 = 16 * kOneVoxelQ8;
  return std::min(edge_length / kPartsOfEdge, kLongestQ8);
}

SplitEdges::SplitEdges(FineMesh& mesh, int64_t memory_bytes) {
  list_edges(mesh);
  const size_t vertices = mesh.position.size();
  const std::map<uint64_t, InnerPoints> on_path = cut_paths(mesh);
  double total = 0;
  const double most = most_points(mesh, memory_bytes);
  for (Edge& e : edges_) {
    const auto found = on_path.find(e.key);
    const auto u = uint32_t(e.key >> 32), v = uint32_t(e.key);
    const WorldPoint &a = mesh.position[u], &b = mesh.position[v];
    const double longest = longest_between(mesh, u, v);
    total += found != on_path.end() ? double(found->second.position.size()) : std::sqrt(distance_sq(a, b)) / longest;
    if (total > most)
      throw Error(ErrorCode::usage, "features",
                  "edges of at most " + std::to_string(longest / kOneVoxelQ8) + " voxels take more than " +
                      std::to_string(int64_t(most)) +
                      " points on the input's edges, more than its area or the memory limit allows: it has long thin " +
                      "triangles; mesh the input without features, give it better triangles first, or ask for longer " +
                      "edges");
    e.count = uint32_t(found != on_path.end() ? int64_t(found->second.position.size()) : parts_of(a, b, longest) - 1);
  }
  uint32_t next = uint32_t(vertices);
  for (Edge& e : edges_) e.first = next, next += e.count;
  mesh.position.resize(next);
  mesh.edge_length.resize(next);
  tbb::parallel_for(size_t(0), edges_.size(), [&](size_t i) {
    const Edge& e = edges_[i];
    const auto found = on_path.find(e.key);
    const auto u = uint32_t(e.key >> 32), v = uint32_t(e.key);
    for (uint32_t k = 0; k < e.count; ++k) {
      const bool is_on_path = found != on_path.end();
      mesh.position[e.first + k] =
          is_on_path ? found->second.position[k]
                     : point_between(mesh.position[u], mesh.position[v], int64_t(k) + 1, int64_t(e.count) + 1);
      mesh.edge_length[e.first + k] =
          is_on_path ? found->second.edge_length[k]
                     : value_between(mesh.edge_length[u], mesh.edge_length[v], int64_t(k) + 1, int64_t(e.count) + 1);
    }
  });
  split_paths(mesh);
}

void SplitEdges::list_edges(const FineMesh& mesh) {
  std::vector<uint64_t> keys(3 * mesh.triangles.size());
  tbb::parallel_for(size_t(0), mesh.triangles.size(), [&](size_t t) {
    const auto& c = mesh.triangles[t];
    for (size_t i = 0; i < 3; ++i) keys[3 * t + i] = edge_key(c[i], c[(i + 1) % 3]);
  });
  tbb::parallel_sort(keys.begin(), keys.end());
  keys.erase(std::unique(keys.begin(), keys.end()), keys.end());
  for (const uint64_t key : keys) edges_.push_back({key, 0, 0});
}

const SplitEdges::Edge* SplitEdges::find(uint64_t key) const {
  return &*std::lower_bound(edges_.begin(), edges_.end(), key, [](const Edge& e, uint64_t k) { return e.key < k; });
}

void SplitEdges::append_chain(uint32_t u, uint32_t v, std::vector<uint32_t>& out) const {
  const Edge& e = *find(edge_key(u, v));
  out.push_back(u);
  for (uint32_t k = 0; k < e.count; ++k) out.push_back(e.first + (u < v ? k : e.count - 1 - k));
}

void SplitEdges::split_paths(FineMesh& mesh) const {
  for (CurvePath& path : mesh.paths) {
    std::vector<uint32_t> fine;
    for (size_t i = 0; i < path.edge_count(); ++i) append_chain(path.vertex[i], path.edge_end(i), fine);
    if (!path.is_loop) fine.push_back(path.vertex.back());
    path.vertex = std::move(fine);
    measure_path(mesh.position, path);
  }
}

}  // namespace isoshell
