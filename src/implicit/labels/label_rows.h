// The labels of a volume at any place, beside the array, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "isoshell/regions.h"

namespace isoshell {

/// Keeps a reference to the volume.
class LabelRows {
 public:
  explicit LabelRows(const LabelVolume& volume)
      : volume_(volume), outside_(size_t(volume.size_vox[0]), volume.background) {}

  int32_t size(int axis) const { return volume_.size_vox[size_t(axis)]; }
  bool is_periodic(int axis) const { return volume_.is_periodic[size_t(axis)]; }
  int32_t background() const { return volume_.background; }
  /// As many labels as there are along x.
  const int32_t* row(int32_t y, int32_t z) const {
    const bool is_inside = y >= 0 && z >= 0 && y < size(1) && z < size(2);
    return is_inside ? volume_.labels.data() + (size_t(z) * size_t(size(1)) + size_t(y)) * size_t(size(0))
                     : outside_.data();
  }
  bool has_crossings() const { return !volume_.crossings.empty(); }
  /// Of a voxel, which may lie beyond the array on its far sides, and then shares it with others.
  int64_t number_of(Voxel v) const { return (int64_t(v.z) * size(1) + v.y) * size(0) + v.x; }
  int32_t at(Voxel v) const { return v.x >= 0 && v.x < size(0) ? row(v.y, v.z)[v.x] : background(); }

 private:
  const LabelVolume& volume_;
  std::vector<int32_t> outside_;
};

}  // namespace isoshell
