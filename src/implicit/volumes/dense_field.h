// Values on a regular lattice in memory as a field.
#pragma once

#include <string>
#include <vector>

#include "implicit/volumes/scalar_field.h"
#include "isoshell/io/memory_input.h"

namespace isoshell {

/// Blocks whose values are all the same are tiles. Borrows the values.
class DenseField : public ScalarField {
 public:
  /// Cost: one pass over the values. Throws: as surface_of_volume does for what is no volume.
  DenseField(const DenseVolume& volume, const std::string& volume_name, const std::optional<double>& iso);

  std::vector<Voxel> blocks() const override { return blocks_; }
  std::vector<FieldTile> tiles() const override { return tiles_; }
  void copy(Voxel origin, const int size[3], float* to) const override;

 private:
  float at(int64_t x, int64_t y, int64_t z) const {
    return volume_.values[x * volume_.stride[0] + y * volume_.stride[1] + z * volume_.stride[2]];
  }
  void check(const std::string& volume_name) const;
  void split_into_blocks(double& low, double& high);
  void drop_background();
  /// Whether most values at the faces of the array are above `iso`.
  bool is_mostly_above(double iso) const;
  [[noreturn]] void refuse_value(Voxel block) const;

  DenseVolume volume_;
  std::vector<Voxel> blocks_;
  std::vector<FieldTile> tiles_;
};

}  // namespace isoshell
