// trim_to_points (see trim_to_points.h): marching triangles on how far vertices are from points.
#include "implicit/points/trim_to_points.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/index_sets.h"
#include "core/parallel_ranges.h"
#include "geometry/make_one.h"
#include "geometry/outward_normals.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr double kFar = 2;             // spacings; the noise of a scan is about one
constexpr double kBeyond = 4;          // what no point looks the way of, in terms of what is far
constexpr int kRounds = 10;            // in which the distances are evened out
constexpr size_t kNeighbours = 16;     // points among which one looks the surface's way
constexpr double kEdgeEnd = 1. / 16;   // of an edge, which cuts keep away from its ends
constexpr double kSmallestPiece = 30;  // squares of the spacing, of a piece that was cut off from others

/// Per vertex how far it is from points, in terms of what is far; below 1 it is near some. The less a point looks the
/// vertex's way the farther it counts as, up to twice as far: beyond the last points the surface turns in.
std::vector<double> distance_from_points(const PointsOfSurface& of, const TriangleSoup& soup) {
  std::vector<WorldPoint> normal = outward_normals(soup.vertices, soup.triangles);
  for (WorldPoint& n : normal) n = normalised(n);
  const size_t neighbours = std::min(kNeighbours, of.points.position.size());
  std::vector<double> far(soup.vertices.size());
  for_each_index(size_t(0), far.size(), [&](size_t v) {
    std::vector<PointTree::Near> near;
    of.tree.nearest(soup.vertices[v], neighbours, near);
    far[v] = kBeyond;
    for (const auto& [away_sq, i] : near) {
      const double cosine = dot(of.points.normal[i], normal[v]);
      const double spacing = std::max(of.points.spacing, std::sqrt(of.points.area[i]));
      if (cosine > 0) far[v] = std::min(far[v], (2 - cosine) * std::sqrt(away_sq) / (kFar * spacing));
    }
  });
  return far;
}

/// Each value the mean of its own and those of the neighbours, some times over: the border runs along points and not
/// around each of them.
void even_out(const TriangleSoup& soup, std::vector<double>& value) {
  for (int round = 0; round < kRounds; ++round) {
    std::vector<double> sum = value;
    std::vector<uint32_t> count(value.size(), 1);
    for (const auto& t : soup.triangles)
      for (size_t i = 0; i < 3; ++i) {
        sum[t[i]] += value[t[(i + 1) % 3]];
        ++count[t[i]];
      }
    for (size_t v = 0; v < value.size(); ++v) value[v] = sum[v] / count[v];
  }
}

class Trim {
 public:
  Trim(const std::vector<double>& far, TriangleSoup& soup) : far_(far), soup_(soup) {}

  /// The part of every triangle in which that is below 1.
  void cut() {
    std::vector<std::array<uint32_t, 3>> triangles;
    triangles.swap(soup_.triangles);
    for (const auto& t : triangles) {
      std::vector<uint32_t> polygon;
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t u = t[i], v = t[(i + 1) % 3];
        if (is_near(u)) polygon.push_back(u);
        if (is_near(u) != is_near(v)) polygon.push_back(cut_on(u, v));
      }
      for (size_t i = 2; i < polygon.size(); ++i) soup_.triangles.push_back({polygon[0], polygon[i - 1], polygon[i]});
    }
  }

  void drop_small_pieces(double spacing) {
    IndexSets sets{int64_t(soup_.vertices.size())};
    std::vector<double> area(soup_.vertices.size(), 0);
    std::vector<uint8_t> is_cut(soup_.vertices.size(), 0);
    for (const auto& t : soup_.triangles)
      for (const uint32_t v : {t[1], t[2]}) sets.unite(t[0], v);
    for (const auto& t : soup_.triangles) {
      area[sets.root(t[0])] += triangle_area(soup_.vertices[t[0]], soup_.vertices[t[1]], soup_.vertices[t[2]]);
      for (const uint32_t v : t)
        if (v >= far_.size()) is_cut[sets.root(t[0])] = 1;
    }
    const auto is_small = [&](const std::array<uint32_t, 3>& t) {
      const uint32_t piece = sets.root(t[0]);
      return is_cut[piece] && area[piece] < kSmallestPiece * spacing * spacing;
    };
    soup_.triangles.erase(std::remove_if(soup_.triangles.begin(), soup_.triangles.end(), is_small),
                          soup_.triangles.end());
  }

 private:
  bool is_near(uint32_t v) const { return far_[v] < 1; }

  uint32_t cut_on(uint32_t u, uint32_t v) {
    if (u > v) std::swap(u, v);
    const auto [at, is_new] = on_edge_.insert({{u, v}, uint32_t(soup_.vertices.size())});
    if (is_new) {
      const double t = std::clamp((1 - far_[u]) / (far_[v] - far_[u]), kEdgeEnd, 1 - kEdgeEnd);
      const WorldPoint p = soup_.vertices[u], q = soup_.vertices[v];
      soup_.vertices.push_back(p + t * (q - p));
    }
    return at->second;
  }

  const std::vector<double>& far_;
  TriangleSoup& soup_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> on_edge_;
};

}  // namespace

void trim_to_points(const PointsOfSurface& of, TriangleSoup& soup) {
  std::vector<double> far = distance_from_points(of, soup);
  even_out(soup, far);
  Trim trim(far, soup);
  trim.cut();
  trim.drop_small_pieces(of.points.spacing);
  drop_unused_vertices(soup);
  if (soup.triangles.empty())
    throw Error(
        ErrorCode::nothing_to_mesh, "points",
        "no part of their surface has points all around it, and nothing is left with --boundary keep; leave that "
        "out");
}

}  // namespace isoshell
