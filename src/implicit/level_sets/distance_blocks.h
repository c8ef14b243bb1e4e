// The values of a level set at any voxel, in voxels.
#pragma once

#include <cstdint>
#include <vector>

#include "implicit/volumes/scalar_field.h"

namespace isoshell {

class DistanceBlocks {
 public:
  /// Values that are no numbers are those of the background. Cost: linear in the blocks, and 4 bytes for each block of
  /// the box around them. Throws: unreadable_input for a block farther out than kFieldReach; out_of_memory where that
  /// box has more than twice kMaxResolution voxels along an axis, or it all takes more than `most_bytes`, unless these
  /// are 0; usage where the values inside of the band are those of the outside.
  DistanceBlocks(const ScalarField& field, double voxel_size_world, int64_t most_bytes);

  /// Below 0 inside.
  float at(Voxel v) const {
    const int32_t place = place_of_block(v.x >> 3, v.y >> 3, v.z >> 3);
    if (place >= 0) return values_[size_t(place) * 512 + size_t((v.x & 7) * 64 + (v.y & 7) * 8 + (v.z & 7))];
    return place == kOutside ? outside_ : tile_[size_t(kFirstTile - place)];
  }
  /// Whether the block around a voxel has one value.
  bool is_tile(Voxel v) const { return place_of_block(v.x >> 3, v.y >> 3, v.z >> 3) < 0; }
  /// By central differences; as values are in voxels, about of length 1.
  WorldPoint slope(Voxel v) const;
  /// Where values are below 0; no voxel where none is.
  const std::vector<Voxel>& inside_corners() const { return inside_; }
  /// Calls visit(block) for blocks that hold anything but the background, by their coordinates over 8.
  template <class Visit>
  void for_each_block(const Visit& visit) const {
    size_t i = 0;
    for (int32_t x = 0; x < size_.x; ++x)
      for (int32_t y = 0; y < size_.y; ++y)
        for (int32_t z = 0; z < size_.z; ++z)
          if (place_[i++] != kOutside) visit(Voxel{low_.x + x, low_.y + y, low_.z + z});
  }
  /// The value that says that no surface is near, in voxels.
  double band_vox() const { return double(outside_); }
  int64_t bytes() const { return int64_t(4 * (place_.size() + values_.size())); }

 private:
  static constexpr int32_t kOutside = -1, kFirstTile = -2;

  int32_t& place_at(int32_t x, int32_t y, int32_t z) {
    return place_[(size_t(x - low_.x) * size_t(size_.y) + size_t(y - low_.y)) * size_t(size_.z) + size_t(z - low_.z)];
  }
  int32_t place_of_block(int32_t x, int32_t y, int32_t z) const {
    x -= low_.x, y -= low_.y, z -= low_.z;
    if (x < 0 || y < 0 || z < 0 || x >= size_.x || y >= size_.y || z >= size_.z) return kOutside;
    return place_[(size_t(x) * size_t(size_.y) + size_t(y)) * size_t(size_.z) + size_t(z)];
  }
  void hold_box(const ScalarField& field, const std::vector<Voxel>& blocks, const std::vector<FieldTile>& tiles,
                int64_t most_bytes);
  void hold_values(const ScalarField& field, const std::vector<Voxel>& blocks, double voxel_size_world);
  void find_inside();
  bool is_filled() const;

  float outside_;
  Voxel low_{0, 0, 0}, size_{0, 0, 0};  ///< of the box of blocks, in blocks
  std::vector<int32_t> place_;          ///< of each block of the box: its number, kOutside, or kFirstTile less a tile's
  std::vector<float> values_, tile_;
  std::vector<Voxel> inside_;
};

}  // namespace isoshell
