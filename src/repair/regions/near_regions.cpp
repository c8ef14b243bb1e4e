// See near_regions.h.
#include "repair/regions/near_regions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/segment.h"
#include "geometry/triangle_search.h"
#include "measure/box_tree.h"

namespace isoshell {
namespace repair {
namespace {

using Pair = std::array<int32_t, 2>;
using Corners = std::array<WorldPoint, 3>;

Pair pair_of(int32_t a, int32_t b) { return {std::min(a, b), std::max(a, b)}; }

/// The outer faces of regions, towards the background, and the label behind each.
struct OuterFaces {
  std::vector<Corners> corners;
  std::vector<int32_t> label;
};

OuterFaces outer_faces(const TriangleSoup& walls) {
  OuterFaces out;
  for (size_t t = 0; t < walls.triangles.size(); ++t) {
    const auto& [behind, front] = walls.regions.labels[t];
    if (behind == front || front != walls.regions.background) continue;
    const auto& [a, b, c] = walls.triangles[t];
    out.corners.push_back({walls.vertices[a], walls.vertices[b], walls.vertices[c]});
    out.label.push_back(behind);
  }
  return out;
}

/// Regions that have a vertex in common, and those that have one in common with the same third one: this is no gap
/// between them.
std::set<Pair> touching_pairs(const TriangleSoup& walls) {
  std::vector<std::pair<uint32_t, int32_t>> at;  // vertex, label
  for (size_t t = 0; t < walls.triangles.size(); ++t)
    for (const uint32_t v : walls.triangles[t])
      for (const int32_t label : walls.regions.labels[t])
        if (label != walls.regions.background) at.push_back({v, label});
  std::sort(at.begin(), at.end());
  at.erase(std::unique(at.begin(), at.end()), at.end());
  std::map<int32_t, std::set<int32_t>> beside;
  for (size_t i = 0; i < at.size(); ++i)
    for (size_t j = i; j-- > 0 && at[j].first == at[i].first;) {
      beside[at[i].second].insert(at[j].second);
      beside[at[j].second].insert(at[i].second);
    }
  std::set<Pair> pairs;
  for (const auto& [label, others] : beside)
    for (const int32_t other : others) {
      pairs.insert(pair_of(label, other));
      for (const int32_t third : others) pairs.insert(pair_of(other, third));
    }
  return pairs;
}

struct Near {
  double distance_sq = std::numeric_limits<double>::infinity();
  WorldPoint at{0, 0, 0};

  /// Of equal ones that whose place is first.
  void take(double other_sq, const WorldPoint& where) {
    if (other_sq < distance_sq || (other_sq == distance_sq && is_before(where, at))) distance_sq = other_sq, at = where;
  }
};

/// Of two triangles that do not meet.
Near nearest_of(const Corners& s, const Corners& t) {
  Near near;
  for (const WorldPoint& p : s) near.take(nearest_of_triangle(p, t[0], t[1], t[2]).distance_sq, p);
  for (const WorldPoint& p : t) near.take(nearest_of_triangle(p, s[0], s[1], s[2]).distance_sq, p);
  for (size_t i = 0; i < 3; ++i)
    for (size_t j = 0; j < 3; ++j) {
      const auto [p, q] = nearest_of_segments(s[i], s[(i + 1) % 3], t[j], t[(j + 1) % 3]);
      near.take(distance_sq(p, q), p);
    }
  return near;
}

/// Boxes around triangles on a grid of 2^20 steps, wider by half of a distance and a step.
class WideBoxes {
 public:
  WideBoxes(const std::vector<Corners>& faces, double within_world) : faces_(faces), wider_(within_world / 2) {
    WorldBox all = box_of_none();
    for (const Corners& corners : faces)
      for (const WorldPoint& p : corners) stretch(all, p);
    origin_ = all.min;
    step_ = std::max(longest_side(all), std::numeric_limits<double>::min()) / (1 << 20);
  }
  BoxQ8 operator()(uint32_t face) const {
    WorldBox box = box_of_none();
    for (const WorldPoint& p : faces_[face]) stretch(box, p);
    const auto steps = [&](const WorldPoint& p, double by) {
      const auto along = [&](double x, double from) { return int32_t(std::floor((x + by - from) / step_)); };
      return PointQ8{along(p.x, origin_.x), along(p.y, origin_.y), along(p.z, origin_.z)};
    };
    return {steps(box.min, -wider_ - step_), steps(box.max, wider_ + step_)};
  }

 private:
  const std::vector<Corners>& faces_;
  double wider_, step_;
  WorldPoint origin_;
};

}  // namespace

std::vector<NearRegions> find_near_regions(const TriangleSoup& walls, double within_world, const Context& context) {
  const OuterFaces outer = outer_faces(walls);
  if (outer.label.empty() || within_world <= 0) return {};
  const std::set<Pair> touching = touching_pairs(walls);
  const WideBoxes box_of_face(outer.corners, within_world);
  const BoxTree tree(outer.label.size(), box_of_face);
  std::vector<std::map<Pair, Near>> of_group(tree.groups());
  for_each_index(size_t(0), of_group.size(), [&](size_t g) {
    check_cancel(context, "regions");
    tree.for_pairs_of(g, [&](uint32_t s, uint32_t t) {
      const Pair labels = pair_of(outer.label[s], outer.label[t]);
      if (labels[0] == labels[1] || touching.count(labels) != 0) return;
      const Near near = nearest_of(outer.corners[std::min(s, t)], outer.corners[std::max(s, t)]);
      if (near.distance_sq >= within_world * within_world) return;
      of_group[g][labels].take(near.distance_sq, near.at);
    });
  });
  std::map<Pair, Near> nearest;
  for (const auto& found : of_group)
    for (const auto& [labels, near] : found) nearest[labels].take(near.distance_sq, near.at);
  std::vector<NearRegions> out;
  for (const auto& [labels, near] : nearest) out.push_back({labels, std::sqrt(near.distance_sq), near.at});
  std::stable_sort(out.begin(), out.end(),
                   [](const NearRegions& a, const NearRegions& b) { return a.distance_world < b.distance_world; });
  return out;
}

}  // namespace repair
}  // namespace isoshell
