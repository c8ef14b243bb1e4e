// share_of_near_walls (see near_walls.h).
#include "features/walls/near_walls.h"

#include <cmath>
#include <vector>

#include "core/parallel_ranges.h"
#include "features/mesh/editable_mesh.h"
#include "features/mesh/refine_mesh.h"
#include "geometry/world_vector.h"
#include "measure/box_tree.h"
#include "voxel/intersect.h"

namespace isoshell {
namespace {

constexpr size_t kMostSamples = 16384;
constexpr double kNear = 0.5;      ///< edges to another wall
constexpr double kBeside = 0.05;   ///< edges from a wall within which it is not looked for: the wall itself is there
constexpr double kStraight = 0.9;  ///< length of the mean normal within an edge, above which a wall does not bend

class Walls {
 public:
  Walls(const CutSurface& cut, int64_t vertices) : cut_(cut), fine_(*cut.fine), tree_(boxes_of(fine_)) {
    double doubled = 0;
    for (size_t t = 0; t < size(); ++t) doubled += length(normal(t));
    edge_q8_ = std::sqrt(doubled / (std::sqrt(3.) * double(vertices)));
  }

  size_t size() const { return fine_.triangles.size(); }
  bool is_near(size_t t) const {
    const auto& [a, b, c] = fine_.triangles[t];
    const WorldPoint middle = (1. / 3) * (fine_.position[a] + fine_.position[b] + fine_.position[c]);
    const WorldPoint n = normal(t);
    if (!(length(n) > 0)) return false;
    const WorldPoint way = (edge_q8_ / length(n)) * n;
    return (has_wall_along(middle, way) || has_wall_along(middle, -1. * way)) && bends_at(middle, patch(t));
  }

 private:
  static std::vector<BoxQ8> boxes_of(const FineMesh& fine) {
    std::vector<BoxQ8> boxes(fine.triangles.size());
    for_each_index(size_t(0), boxes.size(), [&](size_t t) {
      const auto& [a, b, c] = fine.triangles[t];
      boxes[t] = box_of(rounded_down(fine.position[a]), rounded_down(fine.position[b]), rounded_down(fine.position[c]));
    });
    return boxes;
  }
  WorldPoint normal(size_t t) const {
    const auto& [a, b, c] = fine_.triangles[t];
    return doubled_area(fine_.position[a], fine_.position[b], fine_.position[c]);
  }
  uint32_t patch(size_t t) const { return cut_.surface.patch[cut_.corner[3 * t]]; }

  bool has_wall_along(const WorldPoint& from, const WorldPoint& way) const {
    const PointQ8 p = rounded_down(from + kBeside * way), q = rounded_down(from + kNear * way);
    return !tree_.for_all_meeting(box_of(p, q), [&](uint32_t t) {
      const auto& [a, b, c] = fine_.triangles[t];
      return !segment_meets_triangle(p, q, rounded_down(fine_.position[a]), rounded_down(fine_.position[b]),
                                     rounded_down(fine_.position[c]));
    });
  }
  bool bends_at(const WorldPoint& middle, uint32_t of_patch) const {
    WorldPoint sum{0, 0, 0};
    double doubled = 0;
    const PointQ8 at = rounded_down(middle);
    tree_.for_all_meeting(widened(box_of(at, at), int32_t(edge_q8_ / 2)), [&](uint32_t t) {
      if (patch(t) != of_patch) return true;
      sum = sum + normal(t);
      doubled += length(normal(t));
      return true;
    });
    return length(sum) < kStraight * doubled;
  }

  const CutSurface& cut_;
  const FineMesh& fine_;
  const BoxTree tree_;
  double edge_q8_ = 0;
};

}  // namespace

double share_of_near_walls(const CutSurface& cut, int64_t vertices) {
  const Walls walls(cut, vertices);
  const size_t stride = walls.size() / kMostSamples + 1, samples = (walls.size() + stride - 1) / stride;
  const int64_t near = sum_over_ranges(int64_t(samples), 64, [&](int64_t begin, int64_t end) {
    int64_t sum = 0;
    for (int64_t s = begin; s < end; ++s) sum += walls.is_near(size_t(s) * stride) ? 1 : 0;
    return sum;
  });
  return double(near) / double(samples);
}

}  // namespace isoshell
