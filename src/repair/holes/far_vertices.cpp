// See far_vertices.h.
#include "repair/holes/far_vertices.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

#include "core/parallel_ranges.h"
#include "geometry/box.h"
#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

using Face = std::array<uint32_t, 3>;

constexpr double kFarInBodies = 32;     // antennas and tails of real models are shorter
constexpr double kShareOfBody = .75;    // of the faces: a surface of which more is needles is one of needles
constexpr double kLongEdgeOfBox = .25;  // shorter ones reach no vertex that is far away

double longest_edge_sq(const TriangleSoup& soup, const Face& f) {
  const WorldPoint &a = soup.vertices[f[0]], &b = soup.vertices[f[1]], &c = soup.vertices[f[2]];
  return std::max({distance_sq(a, b), distance_sq(b, c), distance_sq(c, a)});
}

bool has_long_edge(const TriangleSoup& soup) {
  const auto box_at = [&](size_t f) {
    const auto& [a, b, c] = soup.triangles[f];
    return box_of(soup.vertices[a], soup.vertices[b], soup.vertices[c]);
  };
  const auto longest_sq_at = [&](size_t f) { return longest_edge_sq(soup, soup.triangles[f]); };
  const size_t faces = soup.triangles.size();
  const double side = longest_side(joined_over(faces, box_of_none(), box_at, joined<WorldPoint>));
  const double longest_sq = joined_over(faces, 0., longest_sq_at, [](double a, double b) { return std::max(a, b); });
  return longest_sq > kLongEdgeOfBox * side * kLongEdgeOfBox * side;
}

WorldBox box_of_body(const TriangleSoup& soup) {
  std::vector<double> longest_sq;
  longest_sq.reserve(soup.triangles.size());
  for (const Face& f : soup.triangles) longest_sq.push_back(longest_edge_sq(soup, f));
  std::vector<double> in_order = longest_sq;
  const auto last = in_order.begin() +
                    std::min<int64_t>(int64_t(kShareOfBody * double(in_order.size())), int64_t(in_order.size()) - 1);
  std::nth_element(in_order.begin(), last, in_order.end());
  WorldBox body = box_of_none();
  for (size_t f = 0; f < longest_sq.size(); ++f)
    if (longest_sq[f] <= *last)
      for (const uint32_t v : soup.triangles[f]) stretch(body, soup.vertices[v]);
  return body;
}

double distance_to(const WorldBox& box, const WorldPoint& p) {
  const auto outside = [](double low, double high, double at) { return std::max({low - at, at - high, 0.}); };
  return length(
      {outside(box.min.x, box.max.x, p.x), outside(box.min.y, box.max.y, p.y), outside(box.min.z, box.max.z, p.z)});
}

/// Far vertices that faces connect, by the least of their numbers, and the vertices that these faces stand on.
struct Needle {
  std::vector<uint32_t> far, foot;
};

class FarVertices {
 public:
  explicit FarVertices(const TriangleSoup& soup)
      : soup_(soup), body_(box_of_body(soup)), leader_(soup.vertices.size()) {
    std::iota(leader_.begin(), leader_.end(), 0u);
    const double reach = kFarInBodies * longest_side(body_);
    is_far_.reserve(soup.vertices.size());
    for (const WorldPoint& p : soup.vertices) is_far_.push_back(distance_to(body_, p) > reach);
  }

  std::map<uint32_t, Needle> needles() {
    for (const Face& f : soup_.triangles)
      for (size_t i = 0; i < 3; ++i) join(f[i], f[(i + 1) % 3]);
    std::map<uint32_t, Needle> found;
    for (const Face& f : soup_.triangles) add(f, found);
    for (auto& [leader, needle] : found) {
      remove_repeats(needle.far);
      remove_repeats(needle.foot);
    }
    return found;
  }

  double distance(uint32_t v) const { return distance_to(body_, soup_.vertices[v]); }

 private:
  uint32_t leader(uint32_t v) {
    while (leader_[v] != v) v = leader_[v] = leader_[leader_[v]];
    return v;
  }
  void join(uint32_t a, uint32_t b) {
    if (!is_far_[a] || !is_far_[b]) return;
    a = leader(a), b = leader(b);
    leader_[std::max(a, b)] = std::min(a, b);
  }
  void add(const Face& f, std::map<uint32_t, Needle>& found) {
    const auto far = std::find_if(f.begin(), f.end(), [&](uint32_t v) { return is_far_[v] != 0; });
    if (far == f.end()) return;
    for (const uint32_t other : f)  // a face may connect two groups of them
      if (is_far_[other]) {
        Needle& needle = found[leader(other)];
        for (const uint32_t v : f) (is_far_[v] ? needle.far : needle.foot).push_back(v);
      }
  }
  static void remove_repeats(std::vector<uint32_t>& of) {
    std::sort(of.begin(), of.end());
    of.erase(std::unique(of.begin(), of.end()), of.end());
  }

  const TriangleSoup& soup_;
  WorldBox body_;
  std::vector<uint8_t> is_far_;
  std::vector<uint32_t> leader_;
};

WorldBox box_around(const std::vector<WorldPoint>& points, const std::vector<uint32_t>& of) {
  WorldBox box = box_of_none();
  for (const uint32_t v : of) stretch(box, points[v]);
  return box;
}

/// Result: where the foot's middle is, if no side of its box, nor of that of the far end, is as long as an edge.
std::optional<WorldPoint> middle_of_narrow(const std::vector<WorldPoint>& points, const Needle& needle,
                                           double edge_world) {
  if (needle.foot.empty() || longest_side(box_around(points, needle.foot)) >= edge_world ||
      longest_side(box_around(points, needle.far)) >= edge_world)
    return {};
  WorldPoint sum{0, 0, 0};
  for (const uint32_t v : needle.foot) sum = sum + points[v];
  return 1 / double(needle.foot.size()) * sum;
}

double area_of(const TriangleSoup& soup) {
  double area = 0;
  for (const Face& f : soup.triangles)
    area += triangle_area(soup.vertices[f[0]], soup.vertices[f[1]], soup.vertices[f[2]]);
  return area;
}

}  // namespace

std::optional<TriangleSoup> pull_back_far_vertices(const TriangleSoup& soup,
                                                   const std::function<double(double)>& edge_world) {
  if (soup.far.vertices > 0 || soup.triangles.empty() || !has_long_edge(soup)) return {};
  FarVertices far(soup);
  const std::map<uint32_t, Needle> needles = far.needles();
  if (needles.empty()) return {};
  const double widest_world = edge_world(area_of(soup));
  std::vector<std::pair<uint32_t, WorldPoint>> moved;
  FarVertexReport report;
  for (const auto& [leader, needle] : needles) {
    const std::optional<WorldPoint> middle = middle_of_narrow(soup.vertices, needle, widest_world);
    if (!middle) continue;
    for (const uint32_t v : needle.far) {
      moved.push_back({v, *middle});
      if (far.distance(v) <= report.distance_world) continue;
      report.distance_world = far.distance(v);
      report.farthest = soup.vertices[v];
    }
  }
  if (moved.empty()) return {};
  report.vertices = int64_t(moved.size());
  TriangleSoup made = soup;
  made.far = report;
  for (const auto& [v, at] : moved) made.vertices[v] = at;
  return made;
}

}  // namespace isoshell::repair
