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

/// Where a path's edge i is to be cut: at its seeds, and between these into equal parts. A seed that is as good as at a
/// vertex takes that vertex: an edge that short would help nobody.
std::vector<WorldPoint> cut_path_edge(const FineMesh& mesh, const CurvePath& path, size_t i, double step, double near,
                                      double longest) {
  const WorldPoint &from = mesh.position[path.vertex[i]], &to = mesh.position[path.edge_end(i)];
  const double begin = path.at[i], end = i + 1 < path.at.size() ? path.at[i + 1] : path.length;
  std::vector<WorldPoint> stops{from};
  for (double s = std::ceil((begin + near) / step); s * step <= end - near; ++s)
    stops.push_back(from + (s * step - begin) / (end - begin) * (to - from));
  stops.push_back(to);
  std::vector<WorldPoint> out;
  for (size_t k = 0; k + 1 < stops.size(); ++k) {
    const int64_t parts = parts_of(stops[k], stops[k + 1], longest);
    for (int64_t j = k > 0 ? 0 : 1; j < parts; ++j) out.push_back(point_between(stops[k], stops[k + 1], j, parts));
  }
  return out;
}

/// Far more than well-shaped triangles of the same area take, and no more than can be numbered.
double most_points(const FineMesh& mesh, double longest) {
  constexpr double kTimesTheNeed = 32, kAlways = 1 << 20, kCountable = kNone / 8;
  double area = 0;
  for (const auto& t : mesh.triangles)
    area += triangle_area(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]);
  return std::min(kTimesTheNeed * (area / (longest * longest) + double(mesh.triangles.size())) + kAlways, kCountable);
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

SplitEdges::SplitEdges(FineMesh& mesh, const RefineOptions& options) : longest_(options.longest) {
  list_edges(mesh);
  const size_t vertices = mesh.position.size();
  std::map<uint64_t, std::vector<WorldPoint>> on_path;
  for (const CurvePath& path : mesh.paths) {
    const double step = path.length / double(segments_of(path.length, path.least_segments, options.edge_length));
    constexpr double kNearPart = 32;
    const double near = std::min(step, options.edge_length) / kNearPart;
    for (size_t i = 0; i < path.edge_count(); ++i) {
      const uint32_t u = path.vertex[i], v = path.edge_end(i);
      std::vector<WorldPoint>& points = on_path[edge_key(u, v)];
      points = cut_path_edge(mesh, path, i, step, near, longest_);
      if (u > v) std::reverse(points.begin(), points.end());
    }
  }
  double total = 0;
  const double most = most_points(mesh, longest_);
  for (Edge& e : edges_) {
    const auto found = on_path.find(e.key);
    const WorldPoint &a = mesh.position[e.key >> 32], &b = mesh.position[uint32_t(e.key)];
    const double count =
        found != on_path.end() ? double(found->second.size()) : std::sqrt(distance_sq(a, b)) / longest_;
    total += count;
    if (total > most)
      throw Error(ErrorCode::usage, "features",
                  "edges of at most " + std::to_string(longest_ / kOneVoxelQ8) + " voxels take more than " +
                      std::to_string(int64_t(most)) +
                      " points on the input's edges, far more than its area needs: it " +
                      "has long thin triangles; mesh the input without features, give it better triangles first, or " +
                      "ask for longer edges");
    e.count = uint32_t(found != on_path.end() ? int64_t(found->second.size()) : parts_of(a, b, longest_) - 1);
  }
  uint32_t next = uint32_t(vertices);
  for (Edge& e : edges_) e.first = next, next += e.count;
  mesh.position.resize(next);
  tbb::parallel_for(size_t(0), edges_.size(), [&](size_t i) {
    const Edge& e = edges_[i];
    const auto found = on_path.find(e.key);
    const WorldPoint a = mesh.position[e.key >> 32], b = mesh.position[uint32_t(e.key)];
    for (uint32_t k = 0; k < e.count; ++k)
      mesh.position[e.first + k] =
          found != on_path.end() ? found->second[k] : point_between(a, b, int64_t(k) + 1, int64_t(e.count) + 1);
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
    CurvePath fine = path;
    fine.vertex.clear();
    for (size_t i = 0; i < path.edge_count(); ++i) append_chain(path.vertex[i], path.edge_end(i), fine.vertex);
    if (!path.is_loop) fine.vertex.push_back(path.vertex.back());
    measure_path(mesh.position, fine);
    path = std::move(fine);
  }
}

}  // namespace isoshell
