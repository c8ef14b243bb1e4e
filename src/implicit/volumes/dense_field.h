// Values on a regular lattice in memory as a field.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "implicit/volumes/scalar_field.h"
#include "isoshell/io/memory_input.h"

namespace isoshell {

/// Blocks whose values are all the same are tiles. Borrows the values.
class DenseField : public ScalarField {
 public:
  /// Cost: one pass over the values. Throws: as surface_of_volume does for what is no volume.
  DenseField(const DenseVolume& volume, const std::string& volume_name, const VolumeReadOptions& options);

  std::vector<Voxel> blocks() const override { return blocks_; }
  std::vector<FieldTile> tiles() const override { return tiles_; }
  void copy(Voxel origin, const int size[3], float* to) const override;
  std::unique_ptr<ScalarField> continued() const override;

 private:
  /// Of a lattice point; those around the array have the value of the nearest one in it.
  float at(int64_t x, int64_t y, int64_t z) const {
    const auto in_array = [&](int64_t i, int axis) {
      const int64_t size = volume_.size[axis];
      const int64_t place = is_periodic_[size_t(axis)] ? i % size : std::clamp<int64_t>(i - padding_, 0, size - 1);
      return place * volume_.stride[axis];
    };
    return volume_.values[in_array(x, 0) + in_array(y, 1) + in_array(z, 2)];
  }
  float beyond(const int64_t point[3]) const;
  Voxel in_array(Voxel v) const { return {v.x - padding_, v.y - padding_, v.z - padding_}; }
  void check(const std::string& volume_name) const;
  void split_into_blocks(double& low, double& high);
  void drop_background();
  /// Whether most values at the faces of the array, or the nearest known ones, are above `iso`.
  bool is_mostly_above(double iso) const;
  [[noreturn]] void refuse_unknown() const;
  [[noreturn]] void refuse_value(Voxel block) const;

  DenseVolume volume_;
  std::array<bool, 3> is_periodic_;  ///< along these axes the last point is the first one again
  int32_t padding_;                  ///< lattice points around the array
  int64_t size_[3];                  ///< with these
  bool goes_on_ = false;             ///< beyond its sides
  std::vector<Voxel> blocks_;
  std::vector<FieldTile> tiles_;
};

}  // namespace isoshell
