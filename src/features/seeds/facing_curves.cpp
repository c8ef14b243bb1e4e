// See facing_curves.h.
#include "features/seeds/facing_curves.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel_ranges.h"
#include "geometry/segment.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kNarrow = 0.35;  ///< width over the way along the curves, below which a strip is narrow
constexpr double kFar = std::numeric_limits<double>::infinity();

/// Where a vertex is on paths.
struct OnPath {
  uint32_t path;
  size_t index;
  double at;
};

/// Per vertex the vertex of a path that is nearest along edges, within reach; kNone beyond it. Of two that are as near
/// the smaller one.
std::vector<uint32_t> nearest_on_paths(const FineMesh& mesh, const VertexGraph& graph, double reach) {
  using Nearest = std::pair<double, uint32_t>;  // distance, vertex
  std::vector<Nearest> own(mesh.position.size(), Nearest{kFar, kNone});
  for (const CurvePath& path : mesh.paths)
    for (const uint32_t v : path.vertex) own[v] = {0, v};
  const std::vector<Nearest> found = least_values(graph, own, [&](const Nearest& from, double way) {
    return from.first + way <= reach ? Nearest{from.first + way, from.second} : Nearest{kFar, kNone};
  });
  std::vector<uint32_t> nearest(found.size());
  for_each_index(size_t(0), found.size(), [&](size_t v) { nearest[v] = found[v].second; });
  return nearest;
}

/// How far points of paths are from one another along them.
class WaysAlongPaths {
 public:
  explicit WaysAlongPaths(const FineMesh& mesh) : paths_(mesh.paths), first_(mesh.position.size() + 1, 0) {
    for (const CurvePath& path : paths_)
      for (const uint32_t v : path.vertex) ++first_[v + 1];
    for (size_t v = 0; v + 1 < first_.size(); ++v) first_[v + 1] += first_[v];
    on_path_.resize(size_t(first_.back()));
    std::vector<int64_t> next(first_.begin(), first_.end() - 1);
    for (uint32_t p = 0; p < paths_.size(); ++p)
      for (size_t i = 0; i < paths_[p].vertex.size(); ++i)
        on_path_[size_t(next[paths_[p].vertex[i]]++)] = {p, i, paths_[p].at[i]};
  }

  /// By one path, or two that meet in a corner; infinite where neither leads from one to the other.
  double between(uint32_t u, uint32_t v) const {
    double way = kFar;
    for (int64_t i = first_[u]; i < first_[u + 1]; ++i)
      for (int64_t j = first_[v]; j < first_[v + 1]; ++j)
        way = std::min(way, between(on_path_[size_t(i)], on_path_[size_t(j)]));
    return way;
  }

  /// From a point to the edges of paths around a vertex.
  double straight_to(uint32_t v, const WorldPoint& from, const std::vector<WorldPoint>& position) const {
    double least = kFar;
    for (int64_t i = first_[v]; i < first_[v + 1]; ++i) {
      const CurvePath& path = paths_[on_path_[size_t(i)].path];
      const size_t n = path.vertex.size(), k = on_path_[size_t(i)].index;
      if (k > 0 || path.is_loop)
        least = std::min(least, distance_to_segment(from, position[path.vertex[(k + n - 1) % n]], position[v]));
      if (k + 1 < n || path.is_loop)
        least = std::min(least, distance_to_segment(from, position[v], position[path.vertex[(k + 1) % n]]));
    }
    return least;
  }

 private:
  double between(const OnPath& a, const OnPath& b) const {
    const CurvePath &p = paths_[a.path], &q = paths_[b.path];
    const double straight = std::abs(a.at - b.at);
    if (a.path == b.path && p.is_jagged) return 0;  // between teeth are no strips
    if (a.path == b.path)
      return p.is_loop || p.vertex.front() == p.vertex.back() ? std::min(straight, p.length - straight) : straight;
    if (p.is_loop || q.is_loop) return kFar;
    double way = kFar;
    for (const bool p_ends : {false, true})
      for (const bool q_ends : {false, true})
        if ((p_ends ? p.vertex.back() : p.vertex.front()) == (q_ends ? q.vertex.back() : q.vertex.front()))
          way = std::min(way, (p_ends ? p.length - a.at : a.at) + (q_ends ? q.length - b.at : b.at));
    return way;
  }

  const std::vector<CurvePath>& paths_;
  std::vector<int64_t> first_;
  std::vector<OnPath> on_path_;
};

}  // namespace

std::vector<FacingVertices> find_facing_vertices(const FineMesh& mesh, const VertexGraph& graph, double reach) {
  const std::vector<uint32_t> nearest = nearest_on_paths(mesh, graph, reach);
  const WaysAlongPaths ways(mesh);
  const auto append_at = [&](uint32_t u, std::vector<FacingVertices>& found) {
    graph.for_each(u, [&](uint32_t v, double) {
      const uint32_t a = nearest[u], b = nearest[v];
      if (v < u || a == kNone || b == kNone || a == b) return;
      const double way = ways.between(a, b);
      if (length(mesh.position[b] - mesh.position[a]) >= kNarrow * way) return;
      const double gap = std::min(ways.straight_to(a, mesh.position[b], mesh.position),
                                  ways.straight_to(b, mesh.position[a], mesh.position));
      found.push_back({{a, b}, {u, v}, gap});
    });
  };
  constexpr size_t kTogether = 1024;  // vertices that are looked at by one task
  std::vector<std::vector<FacingVertices>> found((nearest.size() + kTogether - 1) / kTogether);
  for_each_index(size_t(0), found.size(), [&](size_t task) {
    for (size_t u = task * kTogether; u < std::min(nearest.size(), (task + 1) * kTogether); ++u)
      append_at(uint32_t(u), found[task]);
  });
  std::vector<FacingVertices> all;
  for (const auto& of_task : found) all.insert(all.end(), of_task.begin(), of_task.end());
  return all;
}

}  // namespace isoshell
