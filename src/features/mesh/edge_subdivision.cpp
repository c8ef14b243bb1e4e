// EdgeSubdivision (see edge_subdivision.h).
#include "features/mesh/edge_subdivision.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "core/parallel_ranges.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/voxel_set.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr double kLongestOnPath = .75;  ///< over that elsewhere: vertices of curves can only move between these points

double longest_between(const FineMesh& mesh, uint32_t u, uint32_t v) {
  return longest_fine_edge(mesh, (mesh.edge_length[u] + mesh.edge_length[v]) / 2);
}

/// Far more than well-shaped triangles of the same area take, and no more than can be numbered or held.
double most_points(const FineMesh& mesh, int64_t memory_bytes) {
  constexpr double kTimesTheNeed = 16, kAlways = 1 << 18, kCountable = kNone / 8;
  constexpr int64_t kBytesPerPoint = 420;  // measured, of the whole run
  std::vector<double> needs(mesh.triangles.size());
  for_each_index(size_t(0), needs.size(), [&](size_t i) {
    const auto& t = mesh.triangles[i];
    const double longest =
        longest_fine_edge(mesh, (mesh.edge_length[t[0]] + mesh.edge_length[t[1]] + mesh.edge_length[t[2]]) / 3);
    needs[i] = triangle_area(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]) / (longest * longest);
  });
  const double need = std::accumulate(needs.begin(), needs.end(), double(needs.size()));
  const double held = memory_bytes > 0 ? double(memory_bytes / kBytesPerPoint) : kCountable;
  return std::min({kTimesTheNeed * need + kAlways, kCountable, held});
}

/// Of the edges, by their smaller ends.
Buckets<uint32_t> larger_ends(const FineMesh& mesh) {
  const auto list = [&](int64_t t, auto put) {
    const auto& c = mesh.triangles[size_t(t)];
    for (size_t i = 0; i < 3; ++i) put(std::min(c[i], c[(i + 1) % 3]), std::max(c[i], c[(i + 1) % 3]));
  };
  return without_repeats(
      sort_into_buckets<uint32_t>(int64_t(mesh.position.size()), int64_t(mesh.triangles.size()), list));
}

}  // namespace

int64_t parts_of(const WorldPoint& a, const WorldPoint& b, double longest) {
  return std::max<int64_t>(1, int64_t(std::ceil(std::sqrt(distance_sq(a, b)) / longest)));
}

WorldPoint point_between(const WorldPoint& a, const WorldPoint& b, int64_t i, int64_t parts) {
  if (is_before(b, a)) return i == parts ? b : b + double(parts - i) / double(parts) * (a - b);
  return i == 0 ? a : a + double(i) / double(parts) * (b - a);
}

double longest_fine_edge(const FineMesh& mesh, double edge_length) {
  constexpr double kLongestQ8 = 16 * kOneVoxelQ8;
  return std::min(edge_length / mesh.parts_of_edge, kLongestQ8);
}

EdgeSubdivision::EdgeSubdivision(FineMesh& mesh, int64_t memory_bytes, const std::vector<uint64_t>* only)
    : larger_end_(larger_ends(mesh)), parts_(size_t(larger_end_.items.size()), Parts{0, 0, kNone}) {
  const std::vector<InnerPoints> on_paths = cut_paths(mesh);
  count_points(mesh, on_paths, memory_bytes, only);
  place_points(mesh, on_paths);
  split_paths(mesh);
}

/// The place of an edge among all.
int64_t EdgeSubdivision::find(uint32_t u, uint32_t v) const {
  const View<const uint32_t> from = larger_end_.in(std::min(u, v));
  return std::lower_bound(from.begin(), from.end(), std::max(u, v)) - larger_end_.items.begin();
}

/// Cuts edge i of a path at its seeds, and between them into equal parts. The next seed of the path is `seed`; where
/// they come to be, counted from the beginning of the edge, is appended to `seed_at`.
EdgeSubdivision::InnerPoints EdgeSubdivision::cut_path_edge(const FineMesh& mesh, const CurvePath& path, size_t i,
                                                            size_t& seed, std::vector<size_t>& seed_at) {
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
    const int64_t parts = parts_of(a, b, kLongestOnPath * longest_between(mesh, u, v));
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
std::vector<EdgeSubdivision::InnerPoints> EdgeSubdivision::cut_paths(FineMesh& mesh) {
  std::vector<InnerPoints> cut;
  for (CurvePath& path : mesh.paths) {
    std::vector<PathPoint> seeds;
    size_t seed = 0, before = 0;
    for (size_t i = 0; i < path.edge_count(); ++i) {
      const uint32_t u = path.vertex[i], v = path.edge_end(i);
      std::vector<size_t> seed_at;
      InnerPoints points = cut_path_edge(mesh, path, i, seed, seed_at);
      for (const size_t at : seed_at) seeds.push_back({before + at, 0});
      before += points.position.size() + 1;
      if (u > v) {  // from the smaller number
        std::reverse(points.position.begin(), points.position.end());
        std::reverse(points.edge_length.begin(), points.edge_length.end());
      }
      parts_[size_t(find(u, v))].on_path = uint32_t(cut.size());
      cut.push_back(std::move(points));
    }
    if (seed < path.seeds.size()) seeds.push_back({before, 0});
    path.seeds = std::move(seeds);
  }
  return cut;
}

void EdgeSubdivision::count_points(const FineMesh& mesh, const std::vector<InnerPoints>& on_paths, int64_t memory_bytes,
                                   const std::vector<uint64_t>* only) {
  const auto is_cut = [&](uint32_t u, uint32_t v) {
    return !only || std::binary_search(only->begin(), only->end(), edge_key(u, v));
  };
  std::vector<double> requested(parts_.size(), 0);
  for_each_index(int64_t(0), larger_end_.count(), [&](int64_t u) {
    for (int64_t i = larger_end_.first[u]; i < larger_end_.first[u + 1]; ++i) {
      const uint32_t v = larger_end_.items[i], path = parts_[size_t(i)].on_path;
      if (path != kNone)
        requested[size_t(i)] = double(on_paths[path].position.size());
      else if (is_cut(uint32_t(u), v))
        requested[size_t(i)] =
            length(mesh.position[v] - mesh.position[size_t(u)]) / longest_between(mesh, uint32_t(u), v);
    }
  });
  const double most = most_points(mesh, memory_bytes), total = std::accumulate(requested.begin(), requested.end(), 0.0);
  if (total > most)
    throw NoRoom("features",
                 "cut into parts, the input's edges take more than " + std::to_string(int64_t(most)) +
                     " points, more than its area or the memory limit allows: it has long thin triangles; mesh the " +
                     "input without features, give it better triangles first, or ask for longer edges");
  uint32_t next = uint32_t(mesh.position.size());
  for (size_t i = 0; i < parts_.size(); ++i) {
    const bool is_on_path = parts_[i].on_path != kNone;
    parts_[i].first = next;
    parts_[i].count = uint32_t(is_on_path ? requested[i] : std::max(1.0, std::ceil(requested[i])) - 1);
    next += parts_[i].count;
  }
}

void EdgeSubdivision::place_points(FineMesh& mesh, const std::vector<InnerPoints>& on_paths) const {
  if (parts_.empty()) return;
  const size_t end = size_t(parts_.back().first) + parts_.back().count;
  mesh.position.resize(end);
  mesh.edge_length.resize(end);
  for_each_index(int64_t(0), larger_end_.count(), [&](int64_t u) {
    for (int64_t i = larger_end_.first[u]; i < larger_end_.first[u + 1]; ++i) {
      const uint32_t v = larger_end_.items[i];
      const auto& [first, count, path] = parts_[size_t(i)];
      for (uint32_t k = 0; k < count; ++k) {
        const auto part = int64_t(k) + 1, parts = int64_t(count) + 1;
        mesh.position[first + k] = path != kNone
                                       ? on_paths[path].position[k]
                                       : point_between(mesh.position[size_t(u)], mesh.position[v], part, parts);
        mesh.edge_length[first + k] =
            path != kNone ? on_paths[path].edge_length[k]
                          : value_between(mesh.edge_length[size_t(u)], mesh.edge_length[v], part, parts);
      }
    }
  });
}

void EdgeSubdivision::append_chain(uint32_t u, uint32_t v, std::vector<uint32_t>& out) const {
  const Parts& e = parts_[size_t(find(u, v))];
  out.push_back(u);
  for (uint32_t k = 0; k < e.count; ++k) out.push_back(e.first + (u < v ? k : e.count - 1 - k));
}

void EdgeSubdivision::split_paths(FineMesh& mesh) const {
  for (CurvePath& path : mesh.paths) {
    std::vector<uint32_t> fine;
    for (size_t i = 0; i < path.edge_count(); ++i) append_chain(path.vertex[i], path.edge_end(i), fine);
    if (!path.is_loop) fine.push_back(path.vertex.back());
    path.vertex = std::move(fine);
    measure_path(mesh.position, path);
  }
}

}  // namespace isoshell
