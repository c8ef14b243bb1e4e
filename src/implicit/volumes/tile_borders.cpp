#include "implicit/volumes/tile_borders.h"

#include <algorithm>

#include "isoshell/error.h"

namespace isoshell {
namespace {

bool smaller(const FieldTile& a, const FieldTile& b) {
  return a.size != b.size ? a.size < b.size : comes_before(a.origin, b.origin);
}

class TileBorders {
 public:
  TileBorders(const ScalarField& field, const std::function<bool(double)>& inside, const std::vector<Voxel>& held,
              int64_t most)
      : field_(field), inside_(inside), held_(held), most_(most), tiles_(field.tiles()) {
    std::sort(tiles_.begin(), tiles_.end(), smaller);
    for (const FieldTile& tile : tiles_)
      if (size_.back() != tile.size) size_.push_back(tile.size);
  }

  std::vector<Voxel> find() {
    for (const FieldTile& tile : tiles_) {
      if (!inside_(tile.value)) continue;
      const size_t level = size_t(std::lower_bound(size_.begin(), size_.end(), tile.size) - size_.begin());
      for (int axis = 0; axis < 3; ++axis)
        for (const int32_t away : {-kFieldBlock, tile.size}) add_slab(moved(tile.origin, axis, away), axis, level);
    }
    return std::move(beside_);
  }

 private:
  static Voxel moved(Voxel v, int axis, int32_t by) {
    (axis == 0 ? v.x : axis == 1 ? v.y : v.z) += by;
    return v;
  }
  /// Calls visit for the corners of a slab's parts, `step` apart. The slab is a block thick along `axis`.
  template <class Visit>
  static void each_part(Voxel corner, int axis, int32_t size, int32_t step, Visit visit) {
    for (int32_t i = 0; i < size; i += step)
      for (int32_t j = 0; j < size; j += step) visit(moved(moved(corner, (axis + 1) % 3, i), (axis + 2) % 3, j));
  }

  /// A slab as wide as tiles of one size: outside or inside where a tile covers it, else looked at in smaller parts.
  void add_slab(Voxel corner, int axis, size_t level) {
    if (const FieldTile* tile = covering(corner, level)) {
      if (!inside_(tile->value)) each_part(corner, axis, size_[level], kFieldBlock, [&](Voxel v) { add(v); });
    } else if (level > 0) {
      each_part(corner, axis, size_[level], size_[level - 1], [&](Voxel v) { add_slab(v, axis, level - 1); });
    } else if (!std::binary_search(held_.begin(), held_.end(), corner, comes_before)) {
      add(corner);
    }
  }

  void add(Voxel block) {
    if (int64_t(beside_.size()) >= most_)
      throw Error(ErrorCode::out_of_memory, "memory",
                  field_.title() + " is solid over tiles whose surface has more than " + std::to_string(most_) +
                      " blocks, which does not fit the memory limit; resample it coarser or raise --max-memory");
    beside_.push_back(block);
  }

  /// The tile of a size, or of a larger one, that holds a point.
  const FieldTile* covering(Voxel v, size_t level) const {
    for (; level < size_.size(); ++level) {
      const int32_t mask = -size_[level];
      const FieldTile sought{{v.x & mask, v.y & mask, v.z & mask}, size_[level], 0};
      const auto tile = std::lower_bound(tiles_.begin(), tiles_.end(), sought, smaller);
      if (tile != tiles_.end() && tile->size == sought.size && tile->origin == sought.origin) return &*tile;
    }
    return nullptr;
  }

  const ScalarField& field_;
  const std::function<bool(double)>& inside_;
  const std::vector<Voxel>& held_;
  const int64_t most_;
  std::vector<FieldTile> tiles_;            ///< by size and place
  std::vector<int32_t> size_{kFieldBlock};  ///< of a block and of tiles, ascending; each divides the next
  std::vector<Voxel> beside_;
};

}  // namespace

std::vector<Voxel> blocks_beside_tiles(const ScalarField& field, const std::function<bool(double)>& inside,
                                       const std::vector<Voxel>& held, int64_t most) {
  return TileBorders(field, inside, held, most).find();
}

}  // namespace isoshell
