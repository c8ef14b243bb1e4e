// See united_field.h.
#include "implicit/level_sets/united_field.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "implicit/level_sets/level_set_voxels.h"

namespace isoshell {
namespace {

class UnitedField : public ScalarField {
 public:
  UnitedField(std::vector<DistanceBlocks> sets, const std::vector<std::string>& names, const std::string& of_file,
              double voxel_size_world)
      : sets_(std::move(sets)), voxels_(sets_, names, of_file), voxel_size_world_(voxel_size_world) {
    for (const DistanceBlocks& set : sets_)
      set.for_each_block([&](Voxel b) {
        const Voxel origin{kFieldBlock * b.x, kFieldBlock * b.y, kFieldBlock * b.z};
        (set.is_tile(origin) ? tile_ : block_).push_back(origin);
      });
    leave_once(block_);
    leave_once(tile_);
    tile_.erase(std::remove_if(tile_.begin(), tile_.end(),
                               [&](Voxel v) { return std::binary_search(block_.begin(), block_.end(), v, before); }),
                tile_.end());
  }

  std::vector<Voxel> blocks() const override { return block_; }
  std::vector<FieldTile> tiles() const override {
    std::vector<FieldTile> tiles;
    for (const Voxel& v : tile_) tiles.push_back({v, kFieldBlock, value_at(v, voxels_.sets_around(v))});
    return tiles;
  }
  void copy(Voxel origin, const int size[3], float* to) const override {
    const std::vector<uint32_t>& sets_around = voxels_.sets_around(origin);
    copy_block(size, to, [&](int i) {
      return value_at({origin.x + (i >> 6), origin.y + (i >> 3 & 7), origin.z + (i & 7)}, sets_around);
    });
  }

 private:
  static bool before(Voxel a, Voxel b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }
  static void leave_once(std::vector<Voxel>& list) {
    std::sort(list.begin(), list.end(), before);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  float value_at(Voxel v, const std::vector<uint32_t>& sets_around) const {
    return float(voxel_size_world_ * voxels_.depth_at(v, voxels_.standing_at(v, sets_around)));
  }

  const std::vector<DistanceBlocks> sets_;
  const LevelSetVoxels voxels_;
  const double voxel_size_world_;
  std::vector<Voxel> block_, tile_;  ///< their smallest corners, sorted
};

}  // namespace

std::unique_ptr<ScalarField> united_level_sets(LevelSets sets) {
  std::string name;
  for (const std::string& of : sets.names) name += (name.empty() ? "" : ", ") + of;
  auto united = std::make_unique<UnitedField>(std::move(sets.blocks), sets.names, sets.file, cube_edge(sets.to_world));
  united->file = sets.file;
  united->name = name;
  united->grid_class = sets.grid_class;
  united->background = sets.background;
  united->to_world = sets.to_world;
  return united;
}

}  // namespace isoshell
