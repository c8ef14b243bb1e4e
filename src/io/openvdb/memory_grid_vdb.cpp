// Grids of OpenVDB in memory, and arrays of voxels and values, which become such a grid.
#include <openvdb/openvdb.h>
#include <openvdb/tools/SignedFloodFill.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel_ranges.h"
#include "io/openvdb/field_of_grid.h"
#include "io/openvdb/grid_map.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/held_grid.h"
#include "isoshell/error.h"
#include "isoshell/openvdb.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr int64_t kLeafBytes = 512 * int64_t(sizeof(float)) + 192;  // with masks and allocation, as in a file's grid

/// The descriptor that a file of the grid would have.
VdbGridSpan span_of(const openvdb::GridBase& grid) {
  VdbGridSpan span;
  span.name = grid.getName();
  span.type = grid.type();
  for (auto entry = grid.beginMeta(); entry != grid.endMeta(); ++entry)
    if (entry->second->typeName() == openvdb::StringMetadata::staticTypeName())
      span.texts[entry->first] = static_cast<const openvdb::StringMetadata&>(*entry->second).value();
  return span;
}

class HeldVdbGrid final : public HeldGrid {
 public:
  HeldVdbGrid(openvdb::GridBase::ConstPtr grid, const AffineMap& map, const VdbGridSpan& span)
      : HeldGrid(as_volume(span), as_labels(span)), grid_(std::move(grid)), map_(map), texts_(span.texts) {}

  std::unique_ptr<ScalarField> field() const override {
    std::unique_ptr<ScalarField> field = field_of_grid(grid_, volume());
    field->to_world = map_;
    return field;
  }
  LabelVolume label_volume(const std::string& place, const LabelReadOptions& options) const override {
    return labels_of_grid(MeshSource(place, View<const char>{}), *grid_, labels(), texts_, 0, options);
  }
  std::shared_ptr<const GridField> sampled(const std::string& name) const override {
    return field_of_values(grid_, name);
  }

 private:
  const openvdb::GridBase::ConstPtr grid_;
  const AffineMap map_;  ///< a Transform that OpenVDB makes or copies has lost digits of it
  const std::map<std::string, std::string> texts_;
};

MemoryGrid held(openvdb::GridBase::ConstPtr grid, const AffineMap& map) {
  const VdbGridSpan span = span_of(*grid);
  return MemoryGrid(std::make_shared<HeldVdbGrid>(std::move(grid), map, span));
}

/// A voxel and its index, in an order that has leaves one after another, and in each its voxels by offset.
struct PlacedVoxel {
  uint64_t high, low;

  PlacedVoxel(Voxel v, uint32_t index) {
    constexpr int64_t kBias = kFieldReach / kFieldBlock;  // leaf coordinates have 28 bits then
    const auto leaf = [](int32_t c) { return uint64_t((c >> 3) + kBias); };
    const uint64_t z = leaf(v.z);
    const auto offset = uint64_t((v.x & 7) << 6 | (v.y & 7) << 3 | (v.z & 7));
    high = (leaf(v.x) << 28 | leaf(v.y)) << 8 | z >> 20;
    low = (z & 0xfffff) << 41 | offset << 32 | index;
  }
  uint32_t index() const { return uint32_t(low); }
  int offset() const { return int(low >> 32 & 511); }
  bool is_in_leaf_of(const PlacedVoxel& o) const { return high == o.high && low >> 41 == o.low >> 41; }
  bool is_voxel_of(const PlacedVoxel& o) const { return high == o.high && low >> 32 == o.low >> 32; }
  bool operator<(const PlacedVoxel& o) const { return high != o.high ? high < o.high : low < o.low; }
};

/// Makes the grid of a SparseVolume.
class SparseGrid {
 public:
  SparseGrid(const SparseVolume& volume, std::string name) : volume_(volume), name_(std::move(name)) { check(); }

  VdbFloatGrid::Ptr made(int64_t memory_limit_bytes) {
    sort();
    find_leaves();
    check_memory(memory_limit_bytes);
    auto grid = new_vdb_grid<VdbFloatGrid>("values", float(volume_.background));
    add_vdb_leaves(
        *grid, int64_t(first_.size()) - 1, [&](int64_t l) { return leaf_of(voxel(first_[size_t(l)])); },
        [&](int64_t l, float* values) { return fill(size_t(l), values); });
    if (!volume_.is_level_set) return grid;
    grid->setGridClass(openvdb::GRID_LEVEL_SET);
    openvdb::tools::signedFloodFill(grid->tree());
    return grid;
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const {
    throw Error(ErrorCode::usage, "read", name_ + ": " + what);
  }
  static std::string text_of(Voxel v) {
    return "(" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " + std::to_string(v.z) + ")";
  }

  void check() const {
    const int64_t count = volume_.voxels.size;
    if (count == 0) refuse("has no voxels");
    if (count != volume_.values.size)
      refuse("has " + counted(volume_.values.size, "value") + " and " + counted(count, "voxel") +
             "; give one value a voxel");
    if (count > int64_t(UINT32_MAX)) refuse("has more than " + std::to_string(UINT32_MAX) + " voxels; crop it");
    if (!std::isfinite(float(volume_.background))) refuse("its background must be finite");
    if (!is_invertible(lattice_map(volume_.step_world, volume_.origin_world)))
      refuse("its steps from voxel to voxel span no volume; give three finite ones that do");
    if (volume_.is_level_set) check_signs();
    const int64_t wrong = first_where([&](int64_t i) {
      const Voxel v = volume_.voxels[i];
      return std::isinf(volume_.values[i]) || !is_near(v.x) || !is_near(v.y) || !is_near(v.z);
    });
    if (wrong == count) return;
    const Voxel v = volume_.voxels[wrong];
    if (std::isinf(volume_.values[wrong]))
      refuse("value " + std::to_string(wrong) + ", of voxel " + text_of(v) +
             ", is infinite; values are finite, or NaN where nothing is known");
    refuse("voxel " + std::to_string(wrong) + " is " + text_of(v) + ", farther out than " +
           std::to_string(kFieldReach) + "; shift the coordinates and the origin");
  }
  /// The inside of a level set without its outside would go on without end.
  void check_signs() const {
    if (!(volume_.background > 0))
      refuse("its background is " + std::to_string(volume_.background) +
             "; it must be above 0, the distance outside of a level set");
    if (first_where([&](int64_t i) { return volume_.values[i] >= 0; }) == volume_.voxels.size)
      refuse(
          "none of its values is 0 or above; give voxels on both sides of the surface, where values change their sign");
  }
  static bool is_near(int32_t c) { return c >= -kFieldReach && c < kFieldReach; }

  /// The least index below the number of voxels for which `is_it` holds; that number where there is none.
  template <class Is>
  int64_t first_where(Is is_it) const {
    const int64_t count = volume_.voxels.size;
    return joined_over(
        size_t(count), count, [&](size_t i) { return is_it(int64_t(i)) ? int64_t(i) : count; },
        [](int64_t a, int64_t b) { return std::min(a, b); });
  }

  /// The voxel that comes as the n-th.
  Voxel voxel(size_t n) const { return volume_.voxels[order_[n].index()]; }
  static Voxel leaf_of(Voxel v) { return {v.x >> 3, v.y >> 3, v.z >> 3}; }

  void sort() {
    order_.assign(size_t(volume_.voxels.size), PlacedVoxel({0, 0, 0}, 0));
    for_each_index(size_t(0), order_.size(),
                   [&](size_t i) { order_[i] = PlacedVoxel(volume_.voxels[int64_t(i)], uint32_t(i)); });
    tbb::parallel_sort(order_.begin(), order_.end());
  }

  void find_leaves() {
    for (size_t n = 0; n < order_.size(); ++n) {
      if (n > 0 && order_[n].is_voxel_of(order_[n - 1]))
        refuse("voxel " + text_of(voxel(n)) + " is given twice, as number " + std::to_string(order_[n - 1].index()) +
               " and " + std::to_string(order_[n].index()) + "; give each voxel once");
      if (n == 0 || !order_[n].is_in_leaf_of(order_[n - 1])) first_.push_back(n);
    }
    first_.push_back(order_.size());
  }

  void check_memory(int64_t limit_bytes) const {
    const int64_t bytes = int64_t(first_.size() - 1) * kLeafBytes + int64_t(order_.size() * sizeof order_[0]);
    if (limit_bytes <= 0 || bytes <= limit_bytes) return;
    throw Error(ErrorCode::out_of_memory, "memory",
                name_ + ": its " + counted(volume_.voxels.size, "voxel") + " take " + std::to_string(bytes >> 20) +
                    " MiB as a grid, more than the limit of " + std::to_string(limit_bytes >> 20) +
                    " MiB; crop it or raise --max-memory");
  }

  LeafMask fill(size_t leaf, float* values) const {
    LeafMask mask{};
    for (size_t n = first_[leaf]; n < first_[leaf + 1]; ++n) {
      const int offset = order_[n].offset();
      values[offset] = volume_.values[order_[n].index()];
      mask.word[offset >> 6] |= uint64_t(1) << (offset & 63);
    }
    return mask;
  }

  const SparseVolume& volume_;
  const std::string name_;
  std::vector<PlacedVoxel> order_;
  std::vector<size_t> first_;  ///< per leaf where its voxels begin in that order, then their number
};

}  // namespace

MemoryGrid read_grid(const openvdb::GridBase& grid) {
  initialize_openvdb();
  if (!grid.transform().isLinear())
    throw Error(ErrorCode::unreadable_input, "read",
                "grid \"" + grid.getName() + "\" has the transform " + grid.transform().mapType() +
                    "; only linear ones are read, resample it");
  const auto transform = std::const_pointer_cast<openvdb::math::Transform>(grid.transformPtr());
  return held(grid.copyGridReplacingTransform(transform), affine_map_of(grid));
}

MemoryGrid sparse_grid(const SparseVolume& volume, const std::string& name, int64_t memory_limit_bytes) {
  initialize_openvdb();
  const VdbFloatGrid::Ptr grid = SparseGrid(volume, name).made(memory_limit_bytes);
  grid->setTransform(transform_of(volume.step_world, volume.origin_world, name));
  return held(grid, lattice_map(volume.step_world, volume.origin_world));
}

}  // namespace isoshell
