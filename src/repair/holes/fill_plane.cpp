#include "repair/holes/fill_plane.h"

#include <algorithm>
#include <cmath>

#include "repair/holes/plane_triangulation.h"

namespace isoshell::repair {
namespace {

/// Coordinates in a plane, as its normal looks at one.
class InPlane {
 public:
  explicit InPlane(const FlatRim& rim) : at_(rim.at) {
    const WorldPoint& n = rim.normal;
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const WorldPoint across = x <= y && x <= z ? WorldPoint{1, 0, 0}
                              : y <= z         ? WorldPoint{0, 1, 0}
                                               : WorldPoint{0, 0, 1};
    const WorldPoint u = cross(across, n);
    u_ = 1 / length(u) * u;
    v_ = cross(n, u_);
  }
  std::array<double, 2> of(const WorldPoint& p) const { return {dot(p - at_, u_), dot(p - at_, v_)}; }

 private:
  WorldPoint at_, u_, v_;
};

/// Fills what is between the loops of a plane.
class Filling {
 public:
  Filling(const RepairMesh& mesh, const FlatRim& rim, const Loop& loop) : mesh_(mesh), plane_(rim), loop_(loop) {
    for (const uint32_t h : loop_) vertex_.push_back(mesh_.from(h));
    std::sort(vertex_.begin(), vertex_.end());
    vertex_.erase(std::unique(vertex_.begin(), vertex_.end()), vertex_.end());
  }

  /// None where lines cross or touch, or faces would have an edge that is there already.
  std::vector<Corners> faces() const {
    std::vector<Edge> lines;
    for (const uint32_t h : loop_) lines.push_back({number_of(mesh_.to(h)), number_of(mesh_.from(h))});
    const auto triangles = triangulate_plane(on_lattice(), lines);
    if (!triangles) return {};
    std::vector<Corners> faces;
    for (const auto& [a, b, c] : left_of(lines, *triangles)) faces.push_back({vertex_[a], vertex_[b], vertex_[c]});
    return closes(faces) ? faces : std::vector<Corners>();
  }

 private:
  using Edge = std::array<uint32_t, 2>;

  uint32_t number_of(uint32_t v) const {
    return uint32_t(std::lower_bound(vertex_.begin(), vertex_.end(), v) - vertex_.begin());
  }
  std::array<double, 2> place_of(uint32_t number) const { return plane_.of(mesh_.position[vertex_[number]]); }

  std::vector<PlanePoint> on_lattice() const {
    std::array<double, 2> lo = place_of(0), hi = lo;
    for (uint32_t i = 0; i < vertex_.size(); ++i)
      for (size_t k = 0; k < 2; ++k) {
        lo[k] = std::min(lo[k], place_of(i)[k]);
        hi[k] = std::max(hi[k], place_of(i)[k]);
      }
    const double scale = double(kLargestInPlane) / std::max(hi[0] - lo[0], hi[1] - lo[1]);
    std::vector<PlanePoint> points;
    for (uint32_t i = 0; i < vertex_.size(); ++i) {
      const auto p = place_of(i);
      points.push_back({std::llround(scale * (p[0] - lo[0])), std::llround(scale * (p[1] - lo[1]))});
    }
    return points;
  }

  /// Whether every edge of the loops is passed once, the other way round, and every other one by two of the faces.
  bool closes(const std::vector<Corners>& faces) const {
    std::vector<Edge> passed, wanted;
    for (const uint32_t h : loop_) wanted.push_back({mesh_.to(h), mesh_.from(h)});
    for (const Corners& c : faces)
      for (size_t i = 0; i < 3; ++i) passed.push_back({c[i], c[(i + 1) % 3]});
    std::sort(passed.begin(), passed.end());
    std::sort(wanted.begin(), wanted.end());
    if (std::adjacent_find(passed.begin(), passed.end()) != passed.end() ||
        !std::includes(passed.begin(), passed.end(), wanted.begin(), wanted.end()))
      return false;
    return std::all_of(passed.begin(), passed.end(), [&](const Edge& e) {
      return std::binary_search(wanted.begin(), wanted.end(), e) ||
             (std::binary_search(passed.begin(), passed.end(), Edge{e[1], e[0]}) && !mesh_.has_edge(e[0], e[1]));
    });
  }

  const RepairMesh& mesh_;
  InPlane plane_;
  const Loop& loop_;
  std::vector<uint32_t> vertex_;
};

}  // namespace

bool is_inside(const RepairMesh& mesh, const FlatRim& rim, const Loop& loop, const WorldPoint& p) {
  const InPlane plane(rim);
  const std::array<double, 2> q = plane.of(p);
  bool inside = false;
  for (const uint32_t h : loop) {
    const auto a = plane.of(mesh.position[mesh.from(h)]), b = plane.of(mesh.position[mesh.to(h)]);
    if ((a[1] > q[1]) != (b[1] > q[1]) && q[0] < a[0] + (q[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) inside = !inside;
  }
  return inside;
}

std::vector<Corners> fill_plane(const RepairMesh& mesh, const FlatRim& rim, const Loop& loop) {
  return Filling(mesh, rim, loop).faces();
}

}  // namespace isoshell::repair
