// See path_seeds.h.
#include "features/seeds/path_seeds.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/parallel_ranges.h"
#include "features/seeds/carried_positions.h"
#include "features/seeds/seeds_across.h"
#include "geometry/segment.h"

namespace isoshell {
namespace {

constexpr double kStep = 0.0625;  ///< between places to choose from, in edge lengths
constexpr double kTooSoon = 0.4;  ///< of a step
constexpr double kLongest = 1.6;  ///< segment, in edge lengths
constexpr double kCostOfDistance = 10;
constexpr double kCostOfFacing = 0.08;
constexpr double kGainOfStaying = 0.5;
constexpr int kSweeps = 3;  ///< over the paths that others run along

using PositionsBefore = std::vector<std::vector<PathPoint>>;  ///< per path those of seeds that may stay

/// A place where a seed may be.
struct Candidate {
  PathPoint point;
  WorldPoint position;
  double segments;     ///< from the beginning of the path
  double edge_length;  ///< there
  double cost = 0;     ///< of a seed there
};

PositionsBefore positions_before(const FineMesh& mesh, const std::vector<WorldPoint>& points) {
  PositionsBefore places(mesh.paths.size());
  for (const PositionOnPath& place : positions_on_paths(mesh, points))
    if (place.path != PositionOnPath::kNoPath && place.at.edge < mesh.paths[place.path].edge_count())
      places[place.path].push_back(place.at);
  return places;
}

/// The candidate at a place: a vertex of the path where one is near, else a new one, in the stead of one that is near.
Candidate& candidate_at(const FineMesh& mesh, const CurvePath& path, const std::vector<double>& segments,
                        PathPoint point, double too_soon, std::vector<Candidate>& candidates) {
  const double begin = segments[point.edge], end = segments[point.edge + 1];
  const double at = begin + point.part * (end - begin);
  const auto next = std::lower_bound(candidates.begin() + 1, candidates.end() - 1, at,
                                     [](const Candidate& c, double place) { return c.segments < place; });
  const auto near = at - (next - 1)->segments < next->segments - at ? next - 1 : next;
  const auto is_near = [&](const Candidate& c) { return std::abs(c.segments - at) < too_soon; };
  for (const auto beside : {next - 1, next})
    if (beside->point.part == 0 && is_near(*beside)) return *beside;
  if (at - begin < too_soon) point.part = 0;
  const bool is_at_end = end - at < too_soon;
  const double part = is_at_end ? 1 : point.part;
  const uint32_t u = path.vertex[point.edge], v = path.edge_end(point.edge);
  if (is_at_end) point = {point.edge + 1, 0};
  const Candidate there{point, mesh.position[u] + part * (mesh.position[v] - mesh.position[u]),
                        begin + part * (end - begin), (1 - part) * mesh.edge_length[u] + part * mesh.edge_length[v]};
  if (!is_near(*near)) return *candidates.insert(next, there);
  *near = there;
  return *near;
}

/// All vertices, except those that follow too soon, points between them, and places of seeds that may stay. A loop ends
/// with its first vertex.
std::vector<Candidate> list_candidates(const FineMesh& mesh, const CurvePath& path,
                                       const std::vector<PathPoint>& before) {
  const std::vector<double> segments = segments_along(mesh, path);
  const double step = std::min(kStep, segments.back() / (4 * double(path.least_segments)));
  std::vector<Candidate> out;
  for (size_t i = 0; i < path.edge_count(); ++i) {
    const uint32_t u = path.vertex[i], v = path.edge_end(i);
    const WorldPoint &a = mesh.position[u], &b = mesh.position[v];
    const double whole = segments[i + 1] - segments[i];
    const auto parts = std::max<int64_t>(1, int64_t(std::ceil(whole / step)));
    for (int64_t k = 0; k < parts; ++k) {
      const double part = double(k) / double(parts), at = segments[i] + part * whole;
      if (!out.empty() && at < out.back().segments + kTooSoon * step) continue;
      out.push_back({{i, part}, a + part * (b - a), at, (1 - part) * mesh.edge_length[u] + part * mesh.edge_length[v]});
    }
  }
  while (out.size() > 1 && segments.back() < out.back().segments + kTooSoon * step) out.pop_back();
  const uint32_t end = path.edge_end(path.edge_count() - 1);
  out.push_back({{path.edge_count(), 0}, mesh.position[end], segments.back(), mesh.edge_length[end]});
  for (const PathPoint& point : before)
    candidate_at(mesh, path, segments, point, kTooSoon * step, out).cost = -kGainOfStaying;
  if (path.is_loop) out.front().cost = out.back().cost = std::min(out.front().cost, out.back().cost);
  return out;
}

/// Of a segment, by its length, and by how far from it some places of the path between its ends are.
double cost_of_length(const std::vector<Candidate>& c, size_t from, size_t to) {
  const double uneven = c[to].segments - c[from].segments - 1;
  return uneven * uneven;
}
double cost_of_distance(const std::vector<Candidate>& c, size_t from, size_t to, size_t first, size_t last) {
  double farthest_sq = 0;
  for (size_t i = first; i < last; ++i)
    farthest_sq = std::max(farthest_sq, segment_distance_sq(c[i].position, c[from].position, c[to].position));
  const double edge = (c[from].edge_length + c[to].edge_length) / 2;
  return kCostOfDistance * farthest_sq / (edge * edge);
}

/// The cheapest way from the first to the last; of two that cost the same the one whose last segment is shorter. The
/// bends of a jagged path cost nothing.
std::vector<size_t> cheapest(const std::vector<Candidate>& c, bool is_jagged) {
  std::vector<double> cost(c.size(), std::numeric_limits<double>::infinity());
  std::vector<size_t> before(c.size(), 0);
  cost[0] = 0;
  for (size_t to = 1, usual = 0; to < c.size(); ++to) {
    const auto is_better = [&](double sum, size_t from) {
      return sum < cost[to] || (sum == cost[to] && from > before[to]);
    };
    const auto offer = [&](size_t from) {
      const double of_length = cost_of_length(c, from, to);
      const auto sum_with = [&](double of_distance) { return cost[from] + (of_length + of_distance + c[to].cost); };
      if (!is_better(sum_with(0), from)) return;  // distance does not make it less
      if (is_jagged) {
        cost[to] = sum_with(0), before[to] = from;
        return;
      }
      const size_t middle = (from + to + 1) / 2;
      if (middle < to && !is_better(sum_with(cost_of_distance(c, from, to, middle, middle + 1)), from)) return;
      const double sum = sum_with(cost_of_distance(c, from, to, from + 1, to));
      if (is_better(sum, from)) cost[to] = sum, before[to] = from;
    };
    while (usual + 1 < to && c[to].segments - c[usual].segments > 1) ++usual;
    offer(usual);  // few others can be better then
    for (size_t from = to; from-- > 0;) {
      if (from + 1 < to && c[to].segments - c[from].segments > kLongest) break;
      offer(from);
    }
  }
  std::vector<size_t> way{c.size() - 1};
  while (way.back() != 0) way.push_back(before[way.back()]);
  std::reverse(way.begin(), way.end());
  return way;
}

/// As many equal segments, for paths that need more than the cheapest way has.
std::vector<size_t> even(const std::vector<Candidate>& c, size_t segments) {
  std::vector<size_t> way{0};
  for (size_t s = 1; s < segments; ++s) {
    const double target = c.back().segments * double(s) / double(segments);
    size_t i = way.back() + 1;
    while (i + (segments - s) < c.size() - 1 && std::abs(c[i + 1].segments - target) < std::abs(c[i].segments - target))
      ++i;
    way.push_back(i);
  }
  way.push_back(c.size() - 1);
  return way;
}

/// A loop's, from the one in the first segment that costs least, or the first one farther on that stays, and so ending
/// with that.
std::vector<Candidate> from_cheapest(const std::vector<Candidate>& c) {
  size_t begin = 0;
  for (size_t i = 1; i + 1 < c.size() && c[i].segments < 1; ++i)
    if (c[i].cost < c[begin].cost) begin = i;
  for (size_t i = begin; i + 1 < c.size() && c[begin].cost >= 0; ++i)
    if (c[i].cost < 0) begin = i;
  if (begin == 0) return c;
  std::vector<Candidate> out(c.begin() + int64_t(begin), c.end() - 1);
  const size_t behind = out.size();
  out.insert(out.end(), c.begin(), c.begin() + int64_t(begin) + 1);
  const double first = c[begin].segments;
  for (size_t i = 0; i < out.size(); ++i) out[i].segments += (i < behind ? 0 : c.back().segments) - first;
  return out;
}

void place_seeds(const std::vector<Candidate>& candidates, bool any_stays, CurvePath& path) {
  const auto least = size_t(path.least_segments);
  const auto nearest = std::min(size_t(candidates.back().segments + 0.5), candidates.size() - 1);
  const bool is_even = path.is_jagged && !any_stays;
  std::vector<size_t> way =
      is_even ? even(candidates, std::max<size_t>(1, nearest)) : cheapest(candidates, path.is_jagged);
  if (way.size() - 1 < least) way = even(candidates, least);
  path.seeds.clear();
  for (const size_t i : way) path.seeds.push_back(candidates[i].point);
  if (!path.is_loop) return;
  path.seeds.pop_back();
  std::sort(path.seeds.begin(), path.seeds.end(),
            [](const PathPoint& a, const PathPoint& b) { return std::tie(a.edge, a.part) < std::tie(b.edge, b.part); });
}

bool are_same(const std::vector<PathPoint>& a, const std::vector<PathPoint>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const PathPoint& p, const PathPoint& q) { return p.edge == q.edge && p.part == q.part; });
}

/// Places the seeds of paths that run along one another, again where those across changed. `is_placed`: per path
/// whether its seeds are for those across as they are.
void sweep_over(const std::vector<size_t>& group, const SeedsAcross& across, const PositionsBefore& before,
                std::vector<char>& is_placed, FineMesh& mesh) {
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (const size_t p : group) {
      CurvePath& path = mesh.paths[p];
      if (path.is_jagged || is_placed[p]) continue;
      std::vector<Candidate> candidates = list_candidates(mesh, path, before[p]);
      for (Candidate& c : candidates) c.cost += kCostOfFacing * across.cost(mesh, p, c.point, c.position);
      const std::vector<PathPoint> last = path.seeds;
      place_seeds(path.is_loop ? from_cheapest(candidates) : candidates, !before[p].empty(), path);
      is_placed[p] = 1;
      if (!are_same(last, path.seeds)) across.for_each_beside(p, [&](size_t other) { is_placed[other] = 0; });
    }
}

}  // namespace

std::vector<double> segments_along(const FineMesh& mesh, const CurvePath& path) {
  std::vector<double> out{0};
  for (size_t i = 0; i < path.edge_count(); ++i) {
    const uint32_t u = path.vertex[i], v = path.edge_end(i);
    const double end = i + 1 < path.at.size() ? path.at[i + 1] : path.length;
    out.push_back(out.back() + (end - path.at[i]) * 2 / (mesh.edge_length[u] + mesh.edge_length[v]));
  }
  return out;
}

void place_path_seeds(FineMesh& mesh, const std::vector<FacingVertices>& facing,
                      const std::vector<WorldPoint>& before) {
  const PositionsBefore places = positions_before(mesh, before);
  const SeedsAcross across(mesh, facing);
  const auto is_alone = [&](size_t p) { return mesh.paths[p].is_jagged || !across.beside(p); };
  for_each_index(size_t(0), mesh.paths.size(), [&](size_t p) {
    if (!is_alone(p)) return;
    CurvePath& path = mesh.paths[p];
    const std::vector<Candidate> candidates = list_candidates(mesh, path, places[p]);
    place_seeds(path.is_loop ? from_cheapest(candidates) : candidates, !places[p].empty(), path);
  });
  const std::vector<std::vector<size_t>> groups = across.groups();
  std::vector<char> is_placed(mesh.paths.size(), 0);
  for_each_index(size_t(0), groups.size(), [&](size_t g) { sweep_over(groups[g], across, places, is_placed, mesh); });
}

void begin_loops_at_seeds(FineMesh& mesh) {
  for (CurvePath& path : mesh.paths) {
    if (!path.is_loop) continue;
    const size_t first = path.seeds.front().edge;
    std::rotate(path.vertex.begin(), path.vertex.begin() + int64_t(first), path.vertex.end());
    for (PathPoint& seed : path.seeds) seed.edge -= first;
    measure_path(mesh.position, path);
  }
}

}  // namespace isoshell
