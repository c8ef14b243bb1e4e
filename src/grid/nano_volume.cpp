// A scalar NanoVDB grid in memory, walked without trusting an offset in it.
#include "grid/nano_volume.h"

#include <nanovdb/NanoVDB.h>

#include <cmath>
#include <cstring>
#include <type_traits>

#include "voxel/leaf.h"

namespace isoshell {
namespace {

struct Fault {
  std::string what;
};

template <class BuildT>
class Walk {
 public:
  using Root = typename nanovdb::NanoRoot<BuildT>::DataType;
  using Upper = typename nanovdb::NanoUpper<BuildT>::DataType;
  using Lower = typename nanovdb::NanoLower<BuildT>::DataType;
  using Leaf = typename nanovdb::NanoLeaf<BuildT>::DataType;

  explicit Walk(View<const std::byte> bytes) : bytes_(bytes) {}

  void run(NanoVolume& out) {
    constexpr int64_t kTree = sizeof(nanovdb::GridData);
    const auto* tree = node<nanovdb::NanoTree<BuildT>, 64>(kTree);
    uint64_t root_offset;
    std::memcpy(&root_offset, reinterpret_cast<const std::byte*>(tree) + 24, sizeof root_offset);
    if (root_offset > uint64_t(bytes_.size)) throw Fault{"the root lies outside of the grid"};
    const int64_t at = kTree + int64_t(root_offset);
    const auto* root = node<Root>(at);
    out.background = double(root->mBackground);
    out.value = [](const void* leaf, int offset) {
      return float(static_cast<const Leaf*>(leaf)->getValue(uint32_t(offset)));
    };
    out.is_unset = [](const void* leaf, int offset) {
      const auto* here = static_cast<const Leaf*>(leaf);
      return !here->mValueMask.isOn(uint32_t(offset)) &&
             std::abs(float(here->getValue(uint32_t(offset)))) <= step(*here);
    };
    using Tile = typename Root::Tile;
    for (uint32_t n = 0; n < root->mTableSize; ++n) {
      const auto* tile = node<Tile>(at + int64_t(sizeof(Root)) + int64_t(n) * int64_t(sizeof(Tile)));
      const auto key = tile->origin();
      const Voxel origin = {key[0], key[1], key[2]};
      if (tile->child)
        walk_node<Upper>(origin, child_at(at, tile->child), uppers_, out);
      else
        add_tile(origin, 4096, float(tile->value), out);
    }
  }

 private:
  /// By how much values differ at least from one another: packed ones are rounded to it.
  static float step(const Leaf& leaf) {
    if constexpr (std::is_floating_point_v<BuildT>)
      return 0;
    else
      return leaf.mQuantum;
  }

  /// A struct of the grid, wholly inside of it. `Bytes`: its size, where the type is only a name for it.
  template <class T, size_t Bytes = sizeof(T)>
  const T* node(int64_t at) const {
    if (at < 0 || at % int64_t(alignof(T)) != 0 || at > bytes_.size - int64_t(Bytes))
      throw Fault{"a node at byte " + std::to_string(at) + " lies outside of the grid's " +
                  std::to_string(bytes_.size)};
    return reinterpret_cast<const T*>(bytes_.data + at);
  }
  int64_t child_at(int64_t parent, int64_t offset) const {
    if (offset < -bytes_.size || offset > bytes_.size || offset % kNanoAlignment != 0)
      throw Fault{"the node at byte " + std::to_string(parent) + " has a child " + std::to_string(offset) +
                  " bytes away, outside of the grid"};
    return parent + offset;
  }

  template <class Node>
  void walk_node(Voxel origin, int64_t at, int64_t& visited, NanoVolume& out) {
    const Node* here = node<Node>(at);
    if (++visited > bytes_.size / int64_t(sizeof(Node))) throw Fault{"nodes are referred to more than once"};
    constexpr bool kUpper = sizeof(here->mTable) / sizeof(here->mTable[0]) == 32768;
    constexpr int kLog2 = kUpper ? 5 : 4;
    constexpr int32_t kChild = kUpper ? 128 : 8;
    for (uint32_t n = 0; n < 1u << (3 * kLog2); ++n) {
      const int32_t mask = (1 << kLog2) - 1;
      const Voxel child = {moved(origin.x, int32_t(n >> (2 * kLog2)) * kChild),
                           moved(origin.y, (int32_t(n >> kLog2) & mask) * kChild),
                           moved(origin.z, (int32_t(n) & mask) * kChild)};
      if (!here->mChildMask.isOn(n)) {
        add_tile(child, kChild, float(here->mTable[n].value), out);
      } else if constexpr (kUpper) {
        walk_node<Lower>(child, child_at(at, here->mTable[n].child), lowers_, out);
      } else {
        add_leaf(child, child_at(at, here->mTable[n].child), out);
      }
    }
  }
  static int32_t moved(int32_t from, int32_t by) { return int32_t(uint32_t(from) + uint32_t(by)); }

  void add_leaf(Voxel origin, int64_t at, NanoVolume& out) {
    const Leaf* leaf = node<Leaf>(at);
    if constexpr (!Leaf::FIXED_SIZE) {
      const int log2_bits = leaf->mFlags >> 5;
      if (log2_bits > 4 || at > bytes_.size - int64_t(sizeof(Leaf)) - (64 << log2_bits))
        throw Fault{"the leaf at byte " + std::to_string(at) + " is longer than the grid"};
    }
    if (int64_t(out.leaves.size()) >= bytes_.size / int64_t(sizeof(Leaf)))
      throw Fault{"leaves are referred to more than once"};
    out.leaves.push_back({origin, leaf});
  }

  void add_tile(Voxel origin, int32_t size, float value, NanoVolume& out) {
    if (double(value) != out.background) out.tiles.push_back({origin, size, value});
  }

  View<const std::byte> bytes_;
  int64_t uppers_ = 0, lowers_ = 0;
};

}  // namespace

NanoKind nano_kind(uint32_t grid_type, uint32_t grid_class) {
  using nanovdb::GridClass;
  using nanovdb::GridType;
  NanoKind kind{"unknown", false, "unknown"};
  if (grid_class == uint32_t(GridClass::LevelSet)) kind.grid_class = "level set";
  if (grid_class == uint32_t(GridClass::FogVolume)) kind.grid_class = "fog volume";
  const auto is = [&](GridType type, const char* name, bool scalar) {
    if (grid_type == uint32_t(type)) kind.type = name, kind.scalar = scalar;
  };
  is(GridType::Float, "float", true);
  is(GridType::Double, "double", true);
  is(GridType::Fp4, "Fp4", true);
  is(GridType::Fp8, "Fp8", true);
  is(GridType::Fp16, "Fp16", true);
  is(GridType::FpN, "FpN", true);
  is(GridType::Boolean, "bool", false);
  is(GridType::Mask, "mask", false);
  is(GridType::Vec3f, "vec3f", false);
  is(GridType::Vec3d, "vec3d", false);
  is(GridType::Int32, "int32", false);
  is(GridType::Int64, "int64", false);
  is(GridType::UInt32, "uint32", false);
  is(GridType::Index, "index", false);
  return kind;
}

NanoHead nano_head_of(View<const std::byte> grid) {
  constexpr char kMagic[] = "NanoVDB";  // one more character says whether it is a grid, or of an older version nothing
  constexpr size_t kMagicBytes = sizeof kMagic - 1;
  NanoHead head;
  nanovdb::GridData data;
  if (grid.size < int64_t(sizeof data) || std::memcmp(grid.data, kMagic, kMagicBytes) != 0) {
    head.fault = "its " + std::to_string(grid.size) + " bytes do not begin with a grid's header";
    return head;
  }
  std::memcpy(static_cast<void*>(&data), grid.data, sizeof data);
  if (data.mVersion.getMajor() != nanovdb::Version().getMajor())
    head.fault = "it has version " + std::to_string(data.mVersion.getMajor()) + " of NanoVDB's layout, and " +
                 std::to_string(nanovdb::Version().getMajor()) + " is read";
  head.name.assign(data.mGridName, strnlen(data.mGridName, sizeof data.mGridName));
  head.grid_type = uint32_t(data.mGridType);
  head.grid_class = uint32_t(data.mGridClass);
  head.grid_bytes = data.mGridSize;
  return head;
}

NanoVolume open_nano_volume(View<const std::byte> grid) {
  NanoVolume volume;
  if (grid.size < int64_t(sizeof(nanovdb::GridData) + 64)) {
    volume.fault = "its " + std::to_string(grid.size) + " bytes are fewer than a header's";
    return volume;
  }
  nanovdb::GridData head;
  std::memcpy(static_cast<void*>(&head), grid.data, sizeof head);
  for (int i = 0; i < 9; ++i) volume.matrix[i] = head.mMap.mMatD[i];
  for (int i = 0; i < 3; ++i) volume.shift[i] = head.mMap.mVecD[i];
  try {
    using nanovdb::GridType;
    switch (head.mGridType) {
      case GridType::Float:
        Walk<float>(grid).run(volume);
        break;
      case GridType::Double:
        Walk<double>(grid).run(volume);
        break;
      case GridType::Fp4:
        Walk<nanovdb::Fp4>(grid).run(volume);
        break;
      case GridType::Fp8:
        Walk<nanovdb::Fp8>(grid).run(volume);
        break;
      case GridType::Fp16:
        Walk<nanovdb::Fp16>(grid).run(volume);
        break;
      case GridType::FpN:
        Walk<nanovdb::FpN>(grid).run(volume);
        break;
      default:
        volume.fault = "its values are of another type than the file's index says";
    }
  } catch (const Fault& fault) {
    volume.fault = fault.what;
  }
  return volume;
}

}  // namespace isoshell
