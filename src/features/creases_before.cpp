// See creases_before.h.
#include "features/creases_before.h"

#include <algorithm>
#include <cmath>

#include "core/half_edge_list.h"
#include "core/world_vector.h"

namespace isoshell {
namespace {

constexpr double kReach = 0.5;  ///< edges

constexpr double kSharpCosine = 0.766;  // of 40 degrees

using Triangles = std::vector<std::array<uint32_t, 3>>;

bool is_sharp(const std::vector<WorldPoint>& at, const std::array<uint32_t, 3>& s, const std::array<uint32_t, 3>& t) {
  const WorldPoint a = doubled_area(at[s[0]], at[s[1]], at[s[2]]), b = doubled_area(at[t[0]], at[t[1]], at[t[2]]);
  return dot(a, b) < kSharpCosine * std::sqrt(length_sq(a) * length_sq(b));
}

std::vector<std::array<uint32_t, 2>> sharp_edges(const std::vector<WorldPoint>& at, const Triangles& triangles) {
  std::vector<std::pair<uint64_t, uint32_t>> sides;
  for (size_t t = 0; t < triangles.size(); ++t)
    for (size_t c = 0; c < 3; ++c) sides.push_back({edge_key(triangles[t][c], triangles[t][(c + 1) % 3]), uint32_t(t)});
  std::sort(sides.begin(), sides.end());
  std::vector<std::array<uint32_t, 2>> sharp;
  for (size_t i = 0; i + 1 < sides.size(); ++i)
    if (sides[i].first == sides[i + 1].first &&
        is_sharp(at, triangles[sides[i].second], triangles[sides[i + 1].second]))
      sharp.push_back({uint32_t(sides[i].first >> 32), uint32_t(sides[i].first)});
  return sharp;
}

std::vector<WorldPoint> places_on_edges(const std::vector<std::array<uint32_t, 2>>& edges,
                                        const std::vector<WorldPoint>& at, double most_apart) {
  std::vector<WorldPoint> places;
  for (const auto& [u, v] : edges) {
    const WorldPoint along = at[v] - at[u];
    const auto steps = std::max<int64_t>(1, int64_t(std::ceil(length(along) / most_apart)));
    for (int64_t i = 0; i <= steps; ++i) places.push_back(at[u] + double(i) / double(steps) * along);
  }
  return places;
}

}  // namespace

CreasesBefore::CreasesBefore(const PreviousFrame& previous, double edge_length_world)
    : reach_world_(kReach * edge_length_world),
      places_(places_on_edges(sharp_edges(previous.vertices, previous.triangles), previous.carried, reach_world_)),
      cells_(places_, reach_world_) {}

bool CreasesBefore::are_near(const WorldPoint& place) const {
  const WorldPoint aside{reach_world_, reach_world_, reach_world_};
  bool found = false;
  cells_.for_each_in(place - aside, place + aside,
                     [&](size_t i) { found = found || distance_sq(places_[i], place) < reach_world_ * reach_world_; });
  return found;
}

bool CreasesBefore::hold(const FeatureMesh& mesh, const EdgeChain& chain) const {
  double all = 0, near = 0;
  for (size_t i = 0; i < chain.edge.size(); ++i) {
    const WorldPoint &a = mesh.vertices[chain.vertex[i]], &b = mesh.vertices[chain.vertex[i + 1]];
    const double size = length(b - a);
    all += size;
    near += are_near(0.5 * (a + b)) ? size : 0;
  }
  return 2 * near >= all;
}

}  // namespace isoshell
