// A field with some of its values replaced: makers of level sets fill hollow creases by up to half a voxel.
#pragma once

#include "implicit/volumes/cell_window.h"

namespace isoshell {

/// A value of a block by the offset of its point.
struct PointValue {
  uint16_t offset;
  float value;
};

/// Points that a field has inside, but the sides of a hollow crease outside, ascending, with their distance from the
/// sides. `rise`: the field's distance a voxel.
std::vector<PointValue> find_filled_points(const ScalarField& field, Inside inside, double rise, Voxel block);

class SharpenedField : public ScalarField {
 public:
  /// Blocks of cells, sorted; their points are looked at. The field must outlive this one.
  SharpenedField(const ScalarField& field, Inside inside, double rise, const std::vector<Voxel>& blocks);

  std::vector<Voxel> blocks() const override { return field_.blocks(); }
  std::vector<FieldTile> tiles() const override { return field_.tiles(); }
  void copy(Voxel origin, const int size[3], float* to) const override;

 private:
  const ScalarField& field_;
  const std::vector<Voxel>& blocks_;
  std::vector<std::vector<PointValue>> of_block_;
};

}  // namespace isoshell
