// See point_support.h.
#include "implicit/points/point_support.h"

#include <algorithm>
#include <cmath>

#include "core/index_sets.h"
#include "core/parallel_ranges.h"
#include "geometry/make_one.h"
#include "geometry/outward_normals.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr size_t kPullNeighbours = 16;  // points that a vertex follows
constexpr int kPullSteps = 3;
constexpr double kSupportVoxels = 3;      // a vertex farther than that from every point bridges
constexpr double kPullWidth = 1.0;        // of the weights, in voxels or spacings, whichever is larger
constexpr double kSureCosine = 0.5;       // of vertex and points; where they agree less, points pull less
constexpr double kFoldCosine = 0.5;       // a pull may not turn a triangle farther
constexpr int kHalvings = 3;              // of a pull that folds, before there is none
constexpr size_t kSupportedVertices = 8;  // nearest to a point; it supports the first one that looks its way
constexpr double kMinSupported = 0.1;     // of a component's area, else it is a bubble
constexpr double kSmallestPart = 0.002;   // of the area of all points; a component with less is noise
constexpr int64_t kFewestPoints = 12;     // the same

std::vector<WorldPoint> vertex_normals(const TriangleSoup& soup) {
  std::vector<WorldPoint> normal = outward_normals(soup.vertices, soup.triangles);
  for (WorldPoint& n : normal) n = normalised(n);
  return normal;
}

/// Where the points around a vertex pull it.
class Pull {
 public:
  Pull(const PointsOfSurface& of, const WorldPoint& vertex, const WorldPoint& normal)
      : points_(of.points), voxel_size_(of.voxel_size), normal_(normal) {
    of.tree.nearest(vertex, std::min(kPullNeighbours, points_.position.size()), near_);
    spacing_ = std::sqrt(near_[std::min<size_t>(6, near_.size() - 1)].first) * 0.7071067811865476;
    near_.erase(std::remove_if(near_.begin(), near_.end(),
                               [&](const auto& near) { return dot(points_.normal[near.second], normal) <= 0; }),
                near_.end());
  }

  bool is_supported() const { return !near_.empty() && away_vox() < kSupportVoxels; }

  WorldPoint end(const WorldPoint& start) const {
    if (!is_supported()) return start;
    const double part = std::min(1.0, kSupportVoxels - away_vox()) * std::min(1.0, cosine_at(start) / kSureCosine);
    WorldPoint p = start;
    for (int step = 0; step < kPullSteps; ++step) p = pulled(p);
    return start + part * (p - start);
  }

 private:
  struct Mean {
    WorldPoint normal{0, 0, 0};
    double height = 0, total = 0;
  };

  double away_vox() const { return std::sqrt(near_[0].first) / voxel_size_; }

  Mean mean_at(const WorldPoint& p) const {
    const double width = kPullWidth * std::max(voxel_size_, spacing_);
    Mean mean;
    for (const auto& [unused, i] : near_) {
      const WorldPoint &q = points_.position[i], &n = points_.normal[i];
      // A bell without exp: what libraries round differently decides nothing here either.
      const double t = 1 - distance_sq(p, q) / (9 * width * width);
      if (t <= 0) continue;
      const double weight = t * t * t * t * points_.area[i];
      mean.normal = mean.normal + weight * n;
      mean.height += weight * dot(n, p - q);
      mean.total += weight;
    }
    return mean;
  }
  double cosine_at(const WorldPoint& p) const {
    const WorldPoint mean = mean_at(p).normal;
    const double size = length(mean);
    return size > 0 ? std::max(0.0, dot(mean, normal_) / size) : 0;
  }
  /// Along the mean normal to the mean plane of the points, at most a voxel.
  WorldPoint pulled(const WorldPoint& p) const {
    const Mean mean = mean_at(p);
    const double size = length(mean.normal);
    if (!(mean.total > 0) || size < 0.5 * mean.total) return p;  // sides that face each other: no plane
    return p + std::clamp(-mean.height / mean.total, -voxel_size_, voxel_size_) / size * mean.normal;
  }

  const OrientedPoints& points_;
  const double voxel_size_;
  const WorldPoint normal_;
  std::vector<PointTree::Near> near_;
  double spacing_;
};

/// Corners of triangles that are turned too far by what moves `from` to `to`.
std::vector<uint8_t> folded(const TriangleSoup& soup, const std::vector<WorldPoint>& from,
                            const std::vector<WorldPoint>& to) {
  std::vector<uint8_t> out(from.size());
  for (const auto& t : soup.triangles) {
    const WorldPoint before = doubled_area(from[t[0]], from[t[1]], from[t[2]]),
                     after = doubled_area(to[t[0]], to[t[1]], to[t[2]]);
    if (dot(before, after) >= kFoldCosine * length(before) * length(after)) continue;
    for (const uint32_t v : t) out[v] = 1;
  }
  return out;
}

/// Takes vertices half of their way back, and in the end all of it, until no triangle folds.
void unfold(const TriangleSoup& soup, const std::vector<WorldPoint>& from, std::vector<WorldPoint>& to) {
  std::vector<uint8_t> halvings(from.size());
  for (;;) {
    const std::vector<uint8_t> folds = folded(soup, from, to);
    bool any = false;
    for (size_t v = 0; v < from.size(); ++v) {
      if (!folds[v] || halvings[v] > kHalvings) continue;
      to[v] = halvings[v]++ < kHalvings ? 0.5 * (from[v] + to[v]) : from[v];
      any = true;
    }
    if (!any) return;
  }
}

/// The vertex that each point supports; kNone where none near it looks the point's way.
std::vector<uint32_t> supported_vertices(const PointsOfSurface& of, const TriangleSoup& soup) {
  const std::vector<WorldPoint> normal = vertex_normals(soup);
  const PointTree vertices(soup.vertices);
  const double reach = kSupportVoxels * of.voxel_size;
  std::vector<uint32_t> supported(of.points.position.size(), kNone);
  for_each_index(size_t(0), supported.size(), [&](size_t i) {
    std::vector<PointTree::Near> near;
    vertices.nearest(of.points.position[i], std::min(kSupportedVertices, soup.vertices.size()), near);
    for (const auto& [away_sq, v] : near) {
      if (away_sq >= reach * reach || dot(of.points.normal[i], normal[v]) <= 0) continue;
      supported[i] = v;
      return;
    }
  });
  return supported;
}

/// A component of the surface, and the points that support it.
struct Component {
  double area = 0, six_volume = 0, supported_area = 0;
  int64_t points = 0;
};

class Components {
 public:
  Components(const PointsOfSurface& of, const TriangleSoup& soup)
      : hollows_are_known_(of.points.as_given), sets_(int64_t(soup.vertices.size())) {
    for (const auto& t : soup.triangles)
      for (const uint32_t v : {t[1], t[2]}) sets_.unite(t[0], v);
    component_.resize(soup.vertices.size());
    for (const auto& t : soup.triangles) {
      const WorldPoint &p = soup.vertices[t[0]], &q = soup.vertices[t[1]], &r = soup.vertices[t[2]];
      Component& c = at(t[0]);
      c.area += triangle_area(p, q, r);
      c.six_volume += dot(p - soup.vertices[0], doubled_area(p, q, r));
    }
    const std::vector<uint32_t> supported = supported_vertices(of, soup);
    for (size_t i = 0; i < supported.size(); ++i) {
      if (supported[i] == kNone) continue;
      Component& c = at(supported[i]);
      c.supported_area += of.points.area[i];
      ++c.points;
      supported_area_ += of.points.area[i];
      if (may_stay(c)) most_ = std::max(most_, c.supported_area);
    }
  }

  bool keeps(uint32_t vertex) {
    const Component& c = at(vertex);
    if (!may_stay(c)) return false;
    if (c.supported_area == most_) return true;
    return c.points >= kFewestPoints &&
           c.supported_area >= std::max(kSmallestPart * supported_area_, kMinSupported * c.area);
  }

 private:
  bool may_stay(const Component& c) const { return hollows_are_known_ || c.six_volume >= 0; }
  Component& at(uint32_t vertex) { return component_[sets_.root(vertex)]; }

  const bool hollows_are_known_;
  IndexSets sets_;
  std::vector<Component> component_;  ///< per vertex, at the roots
  double supported_area_ = 0, most_ = 0;
};

}  // namespace

void drop_unsupported(const PointsOfSurface& of, TriangleSoup& soup) {
  if (soup.triangles.empty()) return;
  Components components(of, soup);
  soup.triangles.erase(std::remove_if(soup.triangles.begin(), soup.triangles.end(),
                                      [&](const auto& t) { return !components.keeps(t[0]); }),
                       soup.triangles.end());
  drop_unused_vertices(soup);
}

double held_part(const PointsOfSurface& of, const TriangleSoup& soup) {
  if (soup.vertices.empty()) return 0;
  const PointTree vertices(soup.vertices);
  const double reach = kSupportVoxels * of.voxel_size;
  std::vector<uint8_t> is_held(of.points.position.size());
  for_each_index(size_t(0), is_held.size(), [&](size_t i) {
    std::vector<PointTree::Near> near;
    vertices.nearest(of.points.position[i], 1, near);
    is_held[i] = near[0].first < reach * reach;
  });
  double held = 0, all = 0;
  for (size_t i = 0; i < is_held.size(); ++i) {
    all += of.points.area[i];
    if (is_held[i]) held += of.points.area[i];
  }
  return all > 0 ? held / all : 0;
}

std::vector<uint8_t> find_supported(const PointsOfSurface& of, const TriangleSoup& soup) {
  const std::vector<WorldPoint> normal = vertex_normals(soup);
  std::vector<uint8_t> supported(soup.vertices.size());
  for_each_index(size_t(0), supported.size(),
                 [&](size_t v) { supported[v] = Pull(of, soup.vertices[v], normal[v]).is_supported(); });
  return supported;
}

std::vector<uint8_t> pull_to_points(const PointsOfSurface& of, TriangleSoup& soup) {
  const std::vector<WorldPoint> normal = vertex_normals(soup);
  std::vector<WorldPoint> moved(soup.vertices.size());
  std::vector<uint8_t> supported(soup.vertices.size());
  for_each_index(size_t(0), moved.size(), [&](size_t v) {
    const Pull pull(of, soup.vertices[v], normal[v]);
    supported[v] = pull.is_supported();
    moved[v] = pull.end(soup.vertices[v]);
  });
  unfold(soup, soup.vertices, moved);
  soup.vertices = std::move(moved);
  return supported;
}

}  // namespace isoshell
