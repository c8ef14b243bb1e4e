// See solid_parts.h.
#include "repair/regions/solid_parts.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/index_sets.h"
#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/half_edges.h"
#include "geometry/triangle_list.h"
#include "geometry/weld.h"
#include "geometry/world_vector.h"
#include "repair/solids/winding.h"

namespace isoshell::repair {
namespace {

using Corners = std::array<uint32_t, 3>;

class PartFinder {
 public:
  PartFinder(const TriangleSoup& soup, const Context& context) : context_(context) {
    const WeldedVertices welded = weld_vertices(soup.vertices, soup.triangles);
    point_ = welded.position;
    for (uint32_t t = 0; t < soup.triangles.size(); ++t) {
      Corners corner = soup.triangles[t];
      for (uint32_t& v : corner) v = welded.place[v];
      if (repeats_corner(corner)) continue;
      face_.push_back(corner);
      triangle_.push_back(t);
    }
  }

  std::vector<SolidPart> found() {
    find_parts();
    measure();
    double all = 0;
    for (size_t p = 0; p < parts_.size(); ++p)
      if (is_solid(p)) all += volume6_[p];
    for (size_t p = 0; p < parts_.size(); ++p) parts_[p].is_turned = is_solid(p) && all < 0;
    find_containers();
    return std::move(parts_);
  }

 private:
  void find_parts() {
    const EdgeSides edges = find_edge_sides(face_, point_.size());
    IndexSets sets(int64_t(face_.size()));
    for_each_edge(edges, [&](uint32_t, uint32_t, View<const EdgeSide> sides) {
      for (int64_t i = 1; i < sides.size; ++i) sets.unite(sides[0].half_edge / 3, sides[i].half_edge / 3);
    });
    uint32_t count = 0;
    part_ = sets.numbers(count);
    parts_.resize(count);
    for (size_t f = 0; f < face_.size(); ++f) parts_[part_[f]].triangles.push_back(triangle_[f]);
    for_each_edge(edges, [&](uint32_t, uint32_t, View<const EdgeSide> sides) {
      PartShape& shape = parts_[part_[sides[0].half_edge / 3]].shape;
      const auto start = [&](int64_t i) { return face_[sides[i].half_edge / 3][sides[i].half_edge % 3]; };
      if (sides.size == 1 || (sides.size == 2 && start(0) == start(1)))
        shape = PartShape::open;
      else if (sides.size > 2 && shape == PartShape::closed)
        shape = PartShape::branching;
    });
  }

  void measure() {
    volume6_.assign(parts_.size(), 0);
    box_.assign(parts_.size(), box_of_none());
    std::vector<uint32_t> first(parts_.size(), kNoContainer);
    for (uint32_t f = 0; f < face_.size(); ++f) {
      const uint32_t part = part_[f];
      if (first[part] == kNoContainer) first[part] = face_[f][0];
      const WorldPoint &o = point_[first[part]], &a = point_[face_[f][0]], &b = point_[face_[f][1]],
                       &c = point_[face_[f][2]];
      volume6_[part] += dot(a - o, cross(b - o, c - o));
      box_[part] = joined(box_[part], box_of(a, b, c));
    }
  }

  bool is_solid(size_t part) const { return parts_[part].shape != PartShape::open; }
  bool looks_inward(uint32_t part) const { return is_solid(part) && (volume6_[part] < 0) != parts_[part].is_turned; }

  /// What looks inward and lies in no other part is turned once more; the largest first, as others may lie in them.
  void find_containers() {
    std::vector<uint32_t> first_face(parts_.size(), kNoContainer), inward;
    for (uint32_t f = 0; f < face_.size(); ++f)
      if (looks_inward(part_[f]) && first_face[part_[f]] == kNoContainer) {
        first_face[part_[f]] = f;
        inward.push_back(part_[f]);
      }
    if (inward.empty()) return;
    std::stable_sort(inward.begin(), inward.end(),
                     [&](uint32_t a, uint32_t b) { return std::abs(volume6_[a]) > std::abs(volume6_[b]); });
    const RayColumns rays(point_, face_);
    for (const uint32_t p : inward) {
      check_cancel(context_, "unite");
      parts_[p].container = smallest_around(p, first_face[p], rays);
      if (parts_[p].container == kNoContainer) parts_[p].is_turned = !parts_[p].is_turned;
    }
  }

  /// Of the parts that wind around a face and whose boxes are around the part's.
  uint32_t smallest_around(uint32_t part, uint32_t face, const RayColumns& rays) const {
    const Corners& f = face_[face];
    const WorldPoint middle = (1. / 3) * (point_[f[0]] + point_[f[1]] + point_[f[2]]);
    std::map<uint32_t, int> winding;
    rays.for_each_crossing(middle, face, [&](uint32_t g, int sign) { winding[part_[g]] += sign; });
    uint32_t smallest = kNoContainer;
    for (const auto& [other, times] : winding) {
      if (other == part || times == 0 || !is_solid(other) || looks_inward(other) || !is_within(box_[part], box_[other]))
        continue;
      if (smallest == kNoContainer || std::abs(volume6_[other]) < std::abs(volume6_[smallest])) smallest = other;
    }
    return smallest;
  }

  static bool is_within(const WorldBox& inner, const WorldBox& outer) {
    return inner.min.x > outer.min.x && inner.min.y > outer.min.y && inner.min.z > outer.min.z &&
           inner.max.x < outer.max.x && inner.max.y < outer.max.y && inner.max.z < outer.max.z;
  }

  const Context& context_;
  std::vector<WorldPoint> point_;
  std::vector<Corners> face_;
  std::vector<uint32_t> triangle_;  ///< per face
  std::vector<uint32_t> part_;      ///< per face
  std::vector<SolidPart> parts_;
  std::vector<double> volume6_;  ///< per part, of its faces as they are given
  std::vector<WorldBox> box_;    ///< per part
};

}  // namespace

std::vector<SolidPart> find_solid_parts(const TriangleSoup& soup, const Context& context) {
  return PartFinder(soup, context).found();
}

}  // namespace isoshell::repair
