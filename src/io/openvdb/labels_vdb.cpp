// Reading grids of integers of .vdb files as dense volumes of labels.
#include <openvdb/openvdb.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <new>

#include "core/parallel_ranges.h"
#include "geometry/triangle_list.h"
#include "io/openvdb/field_of_grid.h"
#include "io/openvdb/grid_map.h"
#include "io/openvdb/label_names.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/grid_kinds.h"
#include "io/vdb/vdb_cursor.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr int64_t kMostBytes = std::numeric_limits<int64_t>::max() / 2;

/// Both corners are in it, and none where it is empty.
struct VoxelBox {
  int64_t low[3] = {INT64_MAX, INT64_MAX, INT64_MAX}, high[3] = {INT64_MIN, INT64_MIN, INT64_MIN};

  void expand(const openvdb::Coord& c) {
    for (int i = 0; i < 3; ++i) {
      low[i] = std::min<int64_t>(low[i], c[i]);
      high[i] = std::max<int64_t>(high[i], c[i]);
    }
  }
  void expand(const openvdb::CoordBBox& box) {
    expand(box.min());
    expand(box.max());
  }
  bool empty() const { return low[0] > high[0]; }
  int64_t size(int axis) const { return high[axis] - low[axis] + 1; }
  /// At most kMostBytes, which nothing has.
  int64_t label_bytes() const {
    const double bytes = double(sizeof(int32_t)) * double(size(0)) * double(size(1)) * double(size(2));
    return bytes < double(kMostBytes) ? int64_t(bytes) : kMostBytes;
  }
};

template <class Value>
bool is_label(Value value) {
  return value >= std::numeric_limits<int32_t>::min() && value <= std::numeric_limits<int32_t>::max();
}

/// The voxels of a grid that are active or differ from its background, and their labels.
template <class Value>
class LabelTree {
 public:
  using Grid = VdbGrid<Value>;
  using Leaf = VdbLeaf<Grid>;

  /// Inactive voxels of the grid's background get the label `outside`.
  LabelTree(std::string title, const Grid& grid, int32_t outside)
      : title_(std::move(title)), background_(grid.background()), outside_(outside) {
    grid.tree().getNodes(leaves_);
    auto value = grid.tree().cbeginValueAll();
    value.setMaxDepth(Grid::TreeType::ValueAllCIter::LEAF_DEPTH - 1);
    for (; value; ++value)
      if (value.isValueOn() || *value != background_) tiles_.push_back({value.getBoundingBox(), *value});
    for (const Tile& tile : tiles_) box_.expand(tile.box);
    for (const Leaf* leaf : leaves_) expand(*leaf);
  }

  const VoxelBox& box() const { return box_; }

  /// Of all voxels of the box.
  std::vector<int32_t> labels() const {
    for (const Tile& tile : tiles_) require_label(tile.value, "a tile");
    std::vector<int32_t> labels(size_t(box_.size(0) * box_.size(1) * box_.size(2)), outside_);
    for (const Tile& tile : tiles_) fill(tile, labels);
    constexpr int64_t kNone = std::numeric_limits<int64_t>::max();
    std::atomic<int64_t> first_bad{kNone};
    for_each_index(int64_t(0), int64_t(leaves_.size()), [&](int64_t l) {
      if (copy(*leaves_[size_t(l)], labels)) return;
      int64_t before = first_bad.load();
      while (l < before && !first_bad.compare_exchange_weak(before, l)) continue;
    });
    if (first_bad != kNone) refuse_leaf(*leaves_[size_t(first_bad.load())]);
    return labels;
  }

 private:
  struct Tile {
    openvdb::CoordBBox box;
    Value value;
  };

  void expand(const Leaf& leaf) {
    if (leaf.getValueMask().isOn()) return box_.expand(leaf.getNodeBoundingBox());
    const Value* const values = leaf.buffer().data();
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n)
      if (leaf.isValueOn(n) || values[n] != background_) box_.expand(leaf.offsetToGlobalCoord(n));
  }

  size_t place(int64_t x, int64_t y, int64_t z) const {
    return size_t(((z - box_.low[2]) * box_.size(1) + (y - box_.low[1])) * box_.size(0) + (x - box_.low[0]));
  }

  void fill(const Tile& tile, std::vector<int32_t>& labels) const {
    const openvdb::Coord &low = tile.box.min(), &high = tile.box.max();
    for (int64_t z = low.z(); z <= high.z(); ++z)
      for (int64_t y = low.y(); y <= high.y(); ++y)
        std::fill_n(&labels[place(low.x(), y, z)], size_t(int64_t(high.x()) - low.x() + 1), int32_t(tile.value));
  }

  /// Whether all values are labels. What of the leaf lies outside of the box is background.
  bool copy(const Leaf& leaf, std::vector<int32_t>& labels) const {
    const Value* const values = leaf.buffer().data();
    const openvdb::Coord origin = leaf.origin();
    int64_t from[3], to[3];
    for (int i = 0; i < 3; ++i) {
      from[i] = std::max<int64_t>(origin[i], box_.low[i]);
      to[i] = std::min<int64_t>(int64_t(origin[i]) + 7, box_.high[i]);
    }
    for (int64_t z = from[2]; z <= to[2]; ++z)
      for (int64_t y = from[1]; y <= to[1]; ++y)
        for (int64_t x = from[0]; x <= to[0]; ++x) {
          const auto n = openvdb::Index(((x - origin.x()) << 6) + ((y - origin.y()) << 3) + (z - origin.z()));
          if (values[n] == background_ && !leaf.isValueOn(n)) continue;
          if (!is_label(values[n])) return false;
          labels[place(x, y, z)] = int32_t(values[n]);
        }
    return true;
  }

  void require_label(Value value, const std::string& where) const {
    if (is_label(value)) return;
    throw Error(ErrorCode::unreadable_input, "read",
                title_ + ": " + where + " has the value " + std::to_string(value) +
                    "; labels must fit 32 bits, number them anew");
  }
  [[noreturn]] void refuse_leaf(const Leaf& leaf) const {
    for (openvdb::Index n = 0; n < Leaf::SIZE; ++n) {
      const openvdb::Coord at = leaf.offsetToGlobalCoord(n);
      require_label(leaf.buffer().data()[n], "voxel [" + std::to_string(at.x()) + ", " + std::to_string(at.y()) + ", " +
                                                 std::to_string(at.z()) + "]");
    }
    throw Error(ErrorCode::internal, "read", title_ + ": a value is no label");
  }

  const std::string title_;
  const Value background_;
  const int32_t outside_;
  std::vector<const Leaf*> leaves_;  ///< in the order of the tree
  std::vector<Tile> tiles_;
  VoxelBox box_;
};

/// What a grid is read with and messages about it.
struct Request {
  const MeshSource& source;
  const VolumeGrid& grid;
  int64_t tree_bytes;
  VolumeReadOptions options;
  std::optional<int32_t> background;  ///< of the result

  std::string title() const { return source.name() + ": grid \"" + grid.name + "\""; }
};

void check_box(const Request& request, const VoxelBox& box) {
  if (box.empty())
    throw Error(ErrorCode::nothing_to_mesh, "read",
                request.title() + " holds no labels: all its voxels are inactive and have its background's value");
  check_volume_memory(request.source, request.grid, box.label_bytes() + request.tree_bytes, request.options);
  for (int axis = 0; axis < 3; ++axis)
    if (box.size(axis) > std::numeric_limits<int32_t>::max()) throw std::bad_alloc();
  if (box.label_bytes() == kMostBytes) throw std::bad_alloc();
}

/// The label of what is no region.
template <class Value>
int32_t background_of(const Request& request, const VdbGrid<Value>& grid) {
  if (request.background) return *request.background;
  if (!is_label(grid.background()))
    throw Error(ErrorCode::unreadable_input, "read",
                request.title() + ": its background has the value " + std::to_string(grid.background()) +
                    "; labels must fit 32 bits, number them anew or say by --background which label is no region");
  return int32_t(grid.background());
}

template <class Value>
LabelVolume volume_of(const Request& request, const openvdb::GridBase& any_grid) {
  const auto& grid = static_cast<const VdbGrid<Value>&>(any_grid);
  LabelVolume volume;
  volume.background = background_of<Value>(request, grid);
  const LabelTree<Value> tree(request.title(), grid, volume.background);
  const VoxelBox& box = tree.box();
  check_box(request, box);
  const AffineMap map = affine_map_of(grid);
  double origin[3];
  for (int i = 0; i < 3; ++i) {
    volume.size_vox[size_t(i)] = int32_t(box.size(i));
    volume.step_world[size_t(i)] = {map.at[0][i], map.at[1][i], map.at[2][i]};
    origin[i] = map.at[i][3];
    for (int j = 0; j < 3; ++j) origin[i] += map.at[i][j] * double(box.low[j]);
  }
  volume.origin_world = {origin[0], origin[1], origin[2]};
  if (!is_invertible(map) || !is_finite(volume.origin_world))
    throw Error(ErrorCode::unreadable_input, "read",
                request.title() + " has a transform that is not finite or has no inverse");
  volume.labels = tree.labels();
  return volume;
}

[[noreturn]] void throw_too_large(const std::string& path, const VolumeGrid& grid) {
  throw Error(ErrorCode::out_of_memory, "memory",
              path + ": grid " + grid.text() + " does not fit into memory as an array; crop or coarsen it");
}

}  // namespace

LabelGrid read_label_grid(const MeshSource& source, const LabelReadOptions& options) {
  const std::string& path = source.name();
  if (source.size() == 0) source.nothing_to_mesh("is empty (0 bytes); give a file with labels");
  initialize_openvdb();
  const View<const char> bytes{source.begin(), source.size()};
  const VdbLayout layout = read_vdb_layout(path, bytes);
  std::vector<VolumeGrid> grids;
  for (const VdbGridSpan& span : layout.grids) grids.push_back(as_labels(span));
  const VolumeReadOptions as_options{options.grid, {}, options.memory_limit_bytes};
  const size_t chosen = choose_grid(path, grids, as_options, "of labels");
  const VdbGridSpan& span = layout.grids[chosen];
  const int64_t tree_bytes = check_vdb_tree(path, bytes, span);
  check_volume_memory(source, grids[chosen], tree_bytes, as_options);
  try {
    const openvdb::GridBase::ConstPtr grid = read_vdb_grid(path, bytes, span);
    return {grids[chosen].name, labels_of_grid(source, *grid, grids[chosen], span.texts, tree_bytes, options)};
  } catch (const std::bad_alloc&) {
    throw_too_large(path, grids[chosen]);
  }
}

LabelVolume labels_of_grid(const MeshSource& source, const openvdb::GridBase& grid, const VolumeGrid& about,
                           const std::map<std::string, std::string>& texts, int64_t tree_bytes,
                           const LabelReadOptions& options) {
  const Request request{source, about, tree_bytes, {options.grid, {}, options.memory_limit_bytes}, options.background};
  try {
    LabelVolume volume = about.type == "int32" ? volume_of<int32_t>(request, grid) : volume_of<int64_t>(request, grid);
    volume.names = label_names_of(texts);
    return volume;
  } catch (const std::bad_alloc&) {
    throw_too_large(source.name(), about);
  }
}

LabelVolume read_labels(const std::string& path, const LabelReadOptions& options) {
  ReadingBudget budget(options.memory_limit_bytes);
  const MeshSource source(path, budget);
  return read_label_grid(source, options).volume;
}

}  // namespace isoshell
