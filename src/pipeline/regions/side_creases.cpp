// See side_creases.h.
#include "pipeline/regions/side_creases.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

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

struct SideEdge {
  std::array<uint32_t, 2> ends;
  uint32_t triangle;  ///< by its number among those at sides
};

/// The parts of sides: triangles of one side that share edges.
class SideParts {
 public:
  SideParts(const FeatureMesh& walls, const std::vector<uint8_t>& side) : walls_(walls) {
    const auto is_at_side = [&](uint32_t face) { return side[face] != 0; };
    edges_.reserve(3 * size_t(std::count_if(walls.source_face.begin(), walls.source_face.end(), is_at_side)));
    for (size_t t = 0; t < walls.triangles.size(); ++t) {
      const uint8_t of = side[walls.source_face[t]];
      if (of == 0) continue;
      for (size_t i = 0; i < 3; ++i) {
        const uint32_t a = walls.triangles[t][i], b = walls.triangles[t][(i + 1) % 3];
        edges_.push_back({{std::min(a, b), std::max(a, b)}, uint32_t(side_.size())});
      }
      side_.push_back(of);
      const auto& [a, b, c] = walls.triangles[t];
      area_.push_back(triangle_area(walls.vertices[a], walls.vertices[b], walls.vertices[c]));
    }
    std::sort(edges_.begin(), edges_.end(), [](const SideEdge& a, const SideEdge& b) {
      return a.ends != b.ends ? a.ends < b.ends : a.triangle < b.triangle;
    });
    find_parts();
  }

  EdgeList creases(double narrowest_world) {
    std::vector<double> border(side_.size(), 0);
    for_each_crease([&](size_t begin, size_t end) {
      const auto& [a, b] = edges_[begin].ends;
      const double length_here = length(walls_.vertices[a] - walls_.vertices[b]);
      for (size_t i = begin; i < end; ++i) border[part_[edges_[i].triangle]] += length_here;
    });
    EdgeList found;
    for_each_crease([&](size_t begin, size_t end) {
      const bool is_wide =
          std::any_of(edges_.begin() + ptrdiff_t(begin), edges_.begin() + ptrdiff_t(end), [&](auto& e) {
            const uint32_t part = part_[e.triangle];
            return width_of(area_[part], border[part]) >= narrowest_world;
          });
      if (is_wide) found.push_back(edges_[begin].ends);
    });
    return found;
  }

 private:
  /// Calls visit(begin, end) for the edges with the same ends.
  template <class Visit>
  void for_each_edge(Visit visit) const {
    for (size_t i = 0, j = 0; i < edges_.size(); i = j) {
      while (j < edges_.size() && edges_[j].ends == edges_[i].ends) ++j;
      visit(i, j);
    }
  }
  bool is_within(size_t begin, size_t end) const {
    return end - begin == 2 && side_[edges_[begin].triangle] == side_[edges_[begin + 1].triangle];
  }
  template <class Visit>
  void for_each_crease(Visit visit) const {
    for_each_edge([&](size_t begin, size_t end) {
      if (!is_within(begin, end)) visit(begin, end);
    });
  }

  /// The area of each is that of its first triangle from then on.
  void find_parts() {
    part_.resize(side_.size());
    const View<uint32_t> sets{part_.data(), int64_t(part_.size())};
    for (uint32_t t = 0; t < part_.size(); ++t) part_[t] = t;
    for_each_edge([&](size_t begin, size_t end) {
      if (is_within(begin, end)) join(sets, edges_[begin].triangle, edges_[begin + 1].triangle);
    });
    for (uint32_t t = 0; t < part_.size(); ++t) {
      PointAtRoot{sets}(t);
      if (part_[t] != t) area_[part_[t]] += area_[t];
    }
  }

  const FeatureMesh& walls_;
  std::vector<SideEdge> edges_;
  std::vector<uint8_t> side_;  ///< per triangle at a side
  std::vector<double> area_;
  std::vector<uint32_t> part_;
};

}  // namespace

EdgeList side_creases(const FeatureMesh& walls, const std::vector<uint8_t>& side, double edge_length_world) {
  if (side.empty()) return {};
  return SideParts(walls, side).creases(kNarrow * edge_length_world);
}

}  // namespace isoshell
