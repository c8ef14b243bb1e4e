// Vertices of walls that are pulled towards their neighbours.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "implicit/labels/label_walls.h"
#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/backend.h"

namespace isoshell {

constexpr int32_t kOneVoxelFine = 1 << 16;  ///< until positions are rounded to 1/256 voxel

/// In 1/65536 voxel.
struct FinePoint {
  int32_t x, y, z;
};

/// The faces at each vertex, ascending.
Buckets<uint32_t> faces_at_vertices(const LabelWalls& walls);

/// A vertex follows its neighbours, and one on curves, where edges have other than two faces, those along the curves.
/// It stays within half a voxel of its rest along each axis, and within three eighths where walls are thin. Sums are of
/// integers, and every product is rounded alone: no order shows.
class ElasticNet {
 public:
  /// Every vertex is at rest. The walls must outlive it.
  ElasticNet(const LabelWalls& walls, const Buckets<uint32_t>& faces_at);

  /// Every vertex goes this share of the way to the mean of those that it follows.
  void step(double share);
  /// Gives back what steps took from the coarse shape: every vertex goes the way back to its rest, after so many steps
  /// between the vertices have smoothed these ways. Throws: interrupted.
  void twice(int steps, double share, const Context& context);
  /// Every vertex v goes by `way(v)`, in voxels.
  template <class Way>
  void move(const Way& way) {
    const auto fine = [](double vox) { return int32_t(std::floor(std::clamp(vox, -1.0, 1.0) * kOneVoxelFine + 0.5)); };
    for_each_index(size_t(0), at_.size(), [&](size_t v) {
      const auto by = way(v);
      const FinePoint& p = at_[v];
      at_[v] = within_reach(v, {p.x + fine(by.x), p.y + fine(by.y), p.z + fine(by.z)});
    });
  }
  std::vector<PointQ8> rounded() const;

 private:
  FinePoint pulled(const std::vector<FinePoint>& field, size_t vertex, double share) const;
  FinePoint within_reach(size_t vertex, const FinePoint& p) const;

  const LabelWalls& walls_;
  Buckets<uint32_t> followed_;
  std::vector<FinePoint> at_, next_;
};

}  // namespace isoshell
