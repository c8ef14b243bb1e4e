// Vertices of walls that bend as little as they can within their voxels.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "implicit/labels/wall_links.h"
#include "isoshell/advanced/lattice_surface.h"

namespace isoshell {

constexpr int32_t kOneVoxelFine = 1 << 16;  ///< until positions are rounded to 1/256 voxel

/// Along x, y and z, in 1/65536 voxel, and 0: what processors add at once.
using FinePoint = int32_t __attribute__((vector_size(16)));

/// Walls are thin plates, and the curves where they meet are rods: the bend at a vertex is its way from the mean of its
/// neighbours, of a curve's vertex those along the curve, and the net has as its energy the sum of their squares. A
/// straight wall has none, however oblique. A corner of curves has no bend of its own. Vertices stay near to their rest
/// along each axis (see box_of). Sums are of integers, and every product is rounded alone: no order shows.
class ElasticNet {
 public:
  /// Every vertex is at rest. None goes farther than `farthest_vox` along an axis, or a quarter more on curves. The
  /// walls must outlive it.
  ElasticNet(const LabelWalls& walls, const Buckets<uint32_t>& faces_at, double farthest_vox);

  /// Every vertex goes this share of the way to the mean of its neighbours, one of curves that of those along curves.
  void step(double share);
  /// So many steps down the slope of the energy, each with the momentum of those before (Nesterov 1983). The bends of
  /// curves count so many times. Walls pull curves along their normals, once these were found.
  /// Calls begin_step(i) before step i, which may throw.
  void unbend(int steps, double stiffness_of_curves, const std::function<void(int)>& begin_step);
  /// Finds the normals of walls beside curves. Along a wall its vertices lie as voxels do, which is no reason for a
  /// curve to follow them.
  void find_normals(const Buckets<uint32_t>& faces_at);
  /// Every vertex v goes by `way(v)`, in voxels.
  template <class Way>
  void move(const Way& way) {
    const auto fine = [](double vox) { return int32_t(std::floor(std::clamp(vox, -1.0, 1.0) * kOneVoxelFine + 0.5)); };
    for_each_index(size_t(0), at_.size(), [&](size_t v) {
      const auto by = way(v);
      at_[v] = within_reach(v, at_[v] + FinePoint{fine(by.x), fine(by.y), fine(by.z), 0});
    });
    tie(at_);
  }
  std::vector<PointQ8> rounded() const;

 private:
  struct Box {
    FinePoint low, high;
  };

  FinePoint rest(size_t vertex) const;
  int32_t reach_of(size_t vertex, double farthest_vox) const;
  Box box_of(size_t vertex, double farthest_vox, const Buckets<uint32_t>& faces_at) const;
  void keep_on_sides(size_t vertex, Box& box) const;
  void tie_boxes();
  void tie(std::vector<FinePoint>& position) const;
  FinePoint mean_way(size_t vertex, const std::vector<FinePoint>& field, int32_t share) const;
  FinePoint pull_of(uint32_t beside) const;
  FinePoint slope_at(size_t vertex) const;
  FinePoint within_reach(size_t vertex, const FinePoint& p) const;

  const LabelWalls& walls_;
  WallLinks links_;
  std::vector<FinePoint> at_, bend_;
  std::vector<Box> box_;  ///< where each vertex may go
  /// Of vertices beside curves, in 1/32768 of their length; empty until they are found.
  std::vector<FinePoint> normal_;
};

}  // namespace isoshell
