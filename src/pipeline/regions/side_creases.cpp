// See side_creases.h.
#include "pipeline/regions/side_creases.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

constexpr double kNarrow = 2;  ///< edges of the result

/// The shorter side of a rectangle with this area and border.
double width_of(double area, double border) {
  const double square = border * border - 16 * area;
  return square > 0 ? (border - std::sqrt(square)) / 4 : std::sqrt(area);
}

/// The parts of sides: triangles of one side that share edges.
class SideParts {
 public:
  SideParts(const FeatureMesh& walls, const FaceRegions& regions) : walls_(walls), regions_(regions) {
    for (size_t t = 0; t < walls.triangles.size(); ++t) {
      const uint8_t of = regions.side[walls.source_face[t]];
      if (of == 0) continue;
      triangles_.push_back(walls.triangles[t]);
      side_.push_back(of);
      const auto& [a, b, c] = walls.triangles[t];
      area_.push_back(triangle_area(walls.vertices[a], walls.vertices[b], walls.vertices[c]));
    }
    edges_ = find_edge_sides(triangles_, walls.vertices.size());
    find_parts();
  }

  EdgeList creases(double narrowest_world) const {
    std::vector<double> border(side_.size(), 0);
    for_each_crease([&](uint32_t a, uint32_t b, View<const EdgeSide> sides) {
      const double length_here = length(walls_.vertices[a] - walls_.vertices[b]);
      for (const EdgeSide& of : sides) border[part_of(of)] += length_here;
    });
    EdgeList found;
    for_each_crease([&](uint32_t a, uint32_t b, View<const EdgeSide> sides) {
      const bool is_wide = std::any_of(sides.begin(), sides.end(), [&](const EdgeSide& of) {
        return regions_.is_periodic() || width_of(area_[part_of(of)], border[part_of(of)]) >= narrowest_world;
      });
      if (is_wide) found.push_back({a, b});
    });
    return found;
  }

 private:
  uint32_t part_of(const EdgeSide& of) const { return part_[of.half_edge / 3]; }
  bool is_within(View<const EdgeSide> sides) const {
    return sides.size == 2 && side_[sides[0].half_edge / 3] == side_[sides[1].half_edge / 3];
  }
  template <class Visit>
  void for_each_crease(Visit visit) const {
    for_each_edge(edges_, [&](uint32_t a, uint32_t b, View<const EdgeSide> sides) {
      if (!is_within(sides)) visit(a, b, sides);
    });
  }

  /// The area of each is that of its first triangle from then on.
  void find_parts() {
    part_.resize(side_.size());
    const View<uint32_t> sets{part_.data(), int64_t(part_.size())};
    for (uint32_t t = 0; t < part_.size(); ++t) part_[t] = t;
    for_each_edge(edges_, [&](uint32_t, uint32_t, View<const EdgeSide> sides) {
      if (is_within(sides)) join(sets, sides[0].half_edge / 3, sides[1].half_edge / 3);
    });
    for (uint32_t t = 0; t < part_.size(); ++t) {
      PointAtRoot{sets}(t);
      if (part_[t] != t) area_[part_[t]] += area_[t];
    }
  }

  const FeatureMesh& walls_;
  const FaceRegions& regions_;
  std::vector<std::array<uint32_t, 3>> triangles_;  ///< those at sides
  std::vector<uint8_t> side_;                       ///< per triangle of these
  std::vector<double> area_;
  EdgeSides edges_;
  std::vector<uint32_t> part_;
};

}  // namespace

EdgeList side_creases(const FeatureMesh& walls, const FaceRegions& regions, double edge_length_world) {
  if (regions.side.empty()) return {};
  return SideParts(walls, regions).creases(kNarrow * edge_length_world);
}

}  // namespace isoshell
