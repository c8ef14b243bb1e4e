#include "implicit/volumes/sharpened_field.h"

#include "core/parallel_ranges.h"
#include "implicit/volumes/tile_borders.h"

namespace isoshell {

SharpenedField::SharpenedField(const ScalarField& field, Inside inside, double rise, const std::vector<Voxel>& blocks)
    : field_(field), blocks_(blocks), of_block_(blocks.size()) {
  file = field.file, name = field.name, grid_class = field.grid_class;
  background = field.background;
  to_world = field.to_world;
  sides = field.sides;
  for_each_index(size_t(0), blocks.size(),
                 [&](size_t b) { of_block_[b] = find_filled_points(field, inside, rise, blocks[b]); });
}

void SharpenedField::copy(Voxel origin, const int size[3], float* to) const {
  field_.copy(origin, size, to);
  const auto found = std::lower_bound(blocks_.begin(), blocks_.end(), origin, comes_before);
  if (found == blocks_.end() || *found != origin) return;
  for (const PointValue& p : of_block_[size_t(found - blocks_.begin())]) {
    const int at[3] = {p.offset >> 6, p.offset >> 3 & 7, p.offset & 7};
    if (at[0] < size[0] && at[1] < size[1] && at[2] < size[2])
      to[at[0] * kWindowStride[0] + at[1] * kWindowStride[1] + at[2]] = p.value;
  }
}

}  // namespace isoshell
