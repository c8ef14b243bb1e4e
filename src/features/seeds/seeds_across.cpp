// See seeds_across.h.
#include "features/seeds/seeds_across.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "geometry/segment.h"

namespace isoshell {
namespace {

constexpr double kFull = 1.1,
                 kWide = 1.7;         ///< widths of strips, in edge lengths, where seeds across count in full and not
constexpr double kNearEnough = 0.25;  ///< to the middle between two seeds, over half of the way from one to the other
constexpr double kLeastOfEnd = 0.65;  ///< from the end of a path, over the width of the strip: angles of 33 degrees
constexpr double kCostOfEnd = 40;
constexpr int64_t kAround = 3;  ///< edges of the path across that are looked at, to either side

/// The nearest point of a path.
struct Projection {
  double at;  ///< arclength along the path
  double distance;
};

/// To the edges of a path around one of its vertices.
Projection project(const FineMesh& mesh, const CurvePath& path, uint32_t index, const WorldPoint& from) {
  const auto edges = int64_t(path.edge_count());
  Projection best{0, std::numeric_limits<double>::infinity()};
  for (int64_t k = int64_t(index) - kAround; k < int64_t(index) + kAround; ++k) {
    if (!path.is_loop && (k < 0 || k >= edges)) continue;
    const auto edge = size_t(((k % edges) + edges) % edges);
    const WorldPoint &a = mesh.position[path.vertex[edge]], &b = mesh.position[path.edge_end(edge)];
    const double far = distance_to_segment(from, a, b);
    if (far < best.distance) best = {path.at[edge] + nearest_part(from, a, b) * length(b - a), far};
  }
  return best;
}

double arclength(const CurvePath& path, const PathPoint& point) {
  if (point.edge >= path.edge_count()) return path.length;
  const double end = point.edge + 1 < path.at.size() ? path.at[point.edge + 1] : path.length;
  return path.at[point.edge] + point.part * (end - path.at[point.edge]);
}

/// How near a place on a path is to one of its seeds: 1 at it, 0 in the middle between two.
double nearness_to_seed(const CurvePath& path, double at) {
  const auto after = std::partition_point(path.seeds.begin(), path.seeds.end(),
                                          [&](const PathPoint& seed) { return arclength(path, seed) <= at; });
  const bool is_first = after == path.seeds.begin(), is_last = after == path.seeds.end();
  const double before_at = is_first ? arclength(path, path.seeds.back()) - path.length : arclength(path, *(after - 1));
  const double after_at = is_last ? arclength(path, path.seeds.front()) + path.length : arclength(path, *after);
  const double whole = after_at - before_at;
  return whole > 0 ? std::abs(2 * (at - before_at) / whole - 1) : 1;
}

}  // namespace

SeedsAcross::SeedsAcross(const FineMesh& mesh, const std::vector<FacingVertices>& facing)
    : first_(mesh.paths.size() + 1, 0) {
  struct OnPath {
    uint32_t vertex, path, index;
    bool operator<(const OnPath& o) const {
      return std::tie(vertex, path, index) < std::tie(o.vertex, o.path, o.index);
    }
  };
  std::vector<OnPath> on_paths;
  for (uint32_t p = 0; p < mesh.paths.size(); ++p)
    for (uint32_t i = 0; i < mesh.paths[p].vertex.size(); ++i) on_paths.push_back({mesh.paths[p].vertex[i], p, i});
  std::sort(on_paths.begin(), on_paths.end());
  const auto each = [&](uint32_t vertex, auto use) {
    for (auto at = std::lower_bound(on_paths.begin(), on_paths.end(), OnPath{vertex, 0, 0});
         at != on_paths.end() && at->vertex == vertex; ++at)
      use(*at);
  };
  std::vector<std::pair<double, Side>> found;
  for (const FacingVertices& f : facing)
    each(f.on_path[0], [&](const OnPath& a) {
      each(f.on_path[1], [&](const OnPath& b) {
        if (a.path == b.path) return;
        found.push_back({f.gap, {a.path, a.index, b.path, b.index}});
        found.push_back({f.gap, {b.path, b.index, a.path, a.index}});
      });
    });
  const auto key = [](const auto& s) {
    return std::tie(s.second.path, s.second.index, s.second.other, s.first, s.second.other_index);
  };
  std::sort(found.begin(), found.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  for (const auto& [gap, side] : found) {
    const bool is_known = !sides_.empty() && sides_.back().path == side.path && sides_.back().index == side.index &&
                          sides_.back().other == side.other;
    if (!is_known) sides_.push_back(side);
  }
  for (const Side& side : sides_) ++first_[side.path + 1];
  for (size_t p = 0; p + 1 < first_.size(); ++p) first_[p + 1] += first_[p];
}

std::vector<std::vector<size_t>> SeedsAcross::groups() const {
  std::vector<std::vector<size_t>> groups;
  std::vector<char> is_listed(first_.size() - 1, 0);
  for (size_t begin = 0; begin < is_listed.size(); ++begin) {
    if (!beside(begin) || is_listed[begin]) continue;
    std::vector<size_t> group;
    const auto list = [&](size_t path) {
      if (!is_listed[path]) group.push_back(path);
      is_listed[path] = 1;
    };
    list(begin);
    for (size_t i = 0; i < group.size(); ++i) for_each_beside(group[i], list);
    groups.push_back(std::move(group));
  }
  return groups;
}

double SeedsAcross::cost(const FineMesh& mesh, size_t path, const PathPoint& point, const WorldPoint& position) const {
  const CurvePath& own = mesh.paths[path];
  const size_t nearer = point.edge + (point.part > 0.5 ? 1 : 0), index = nearer < own.vertex.size() ? nearer : 0;
  const double edge = mesh.edge_length[own.vertex[index]];
  const auto begin = sides_.begin() + int64_t(first_[path]), end = sides_.begin() + int64_t(first_[path + 1]);
  const double at = arclength(own, point);
  const double from_end = own.is_loop ? own.length : std::min(at, own.length - at);
  double cost = 0;
  for (auto side = std::partition_point(begin, end, [&](const Side& s) { return s.index < index; });
       side != end && side->index == index; ++side) {
    const CurvePath& other = mesh.paths[side->other];
    if (other.seeds.empty()) continue;
    const Projection across = project(mesh, other, side->other_index, position);
    const double narrow = std::clamp((kWide - across.distance / edge) / (kWide - kFull), 0.0, 1.0);
    const double near = std::max(0.0, nearness_to_seed(other, across.at) - kNearEnough) / (1 - kNearEnough);
    const double too_near = std::max(0.0, kLeastOfEnd - from_end / across.distance);
    cost += narrow * (near * near + kCostOfEnd * too_near * too_near);
  }
  return cost;
}

}  // namespace isoshell
