// The only file that knows NanoVDB's node layout: index grids from sorted leaves.
//
// Leaves, lower nodes (16^3 leaves) and upper nodes (32^3 lower nodes) lie one kind after the other in key order, which
// is the order NanoVDB itself builds. Two generations are served. They share the bytes of every node but the leaf:
// before 32.6 a leaf whose flag 16 is set counts its bits on every lookup (build type ValueIndex); since then
// ValueOnIndex keeps the counts of the words before, packed nine bits each.
#include <nanovdb/NanoVDB.h>

#include <cstddef>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "grid/nano_nodes.h"
#include "isoshell/error.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace {

#if NANOVDB_MAJOR_VERSION_NUMBER > 32 || (NANOVDB_MAJOR_VERSION_NUMBER == 32 && NANOVDB_MINOR_VERSION_NUMBER >= 6)
#define ISOSHELL_NANOVDB_ON_INDEX 1
using BuildType = nanovdb::ValueOnIndex;
constexpr nanovdb::GridType kGridType = nanovdb::GridType::OnIndex;
#else
#define ISOSHELL_NANOVDB_ON_INDEX 0
using BuildType = nanovdb::ValueIndex;
constexpr nanovdb::GridType kGridType = nanovdb::GridType::Index;
#endif

using Leaf = nanovdb::NanoLeaf<BuildType>::DataType;
using Lower = nanovdb::NanoLower<BuildType>::DataType;
using Upper = nanovdb::NanoUpper<BuildType>::DataType;
using Root = nanovdb::NanoRoot<BuildType>::DataType;
using Tree = nanovdb::NanoTree<BuildType>::DataType;
using Grid = nanovdb::GridData;
using Box = nanovdb::CoordBBox;

static_assert(sizeof(Leaf) == 96 && sizeof(Grid) == 672 && sizeof(Tree) == 64, "unknown NanoVDB layout");

constexpr uint64_t lower_of_key(uint64_t key) { return key >> 12; }
constexpr uint64_t upper_of_key(uint64_t key) { return key >> 27; }

constexpr uint8_t kHasBox = 2, kOnlyActiveVoxelsCount = 16;
constexpr uint8_t kLeafFlags = ISOSHELL_NANOVDB_ON_INDEX ? kHasBox : kHasBox | kOnlyActiveVoxelsCount;

NanoLayout lay_out(const VoxelSet& voxels, std::vector<uint64_t>& upper_key) {
  int64_t lowers = 0;
  for (int64_t l = 0; l < voxels.leaf_count(); ++l) {
    const uint64_t key = voxels.leaf_key[l], before = l ? voxels.leaf_key[l - 1] : ~uint64_t(0);
    lowers += l == 0 || lower_of_key(key) != lower_of_key(before);
    if (l == 0 || upper_of_key(key) != upper_of_key(before)) upper_key.push_back(upper_of_key(key));
  }
  return nano_layout(voxels.leaf_count(), lowers, int64_t(upper_key.size()), voxels.voxel_count());
}

void write_leaf(Leaf& leaf, Voxel at, const LeafMask& mask, uint64_t first_value) {
  std::memcpy(static_cast<void*>(&leaf.mValueMask), mask.word, sizeof mask.word);
  uint64_t all = 0;
  int lo[3] = {8, 8, 8}, hi[3] = {0, 0, 0};
  const auto stretch = [&](int axis, int i) {
    lo[axis] = i < lo[axis] ? i : lo[axis];
    hi[axis] = i > hi[axis] ? i : hi[axis];
  };
  for (int x = 0; x < 8; ++x) {
    all |= mask.word[x];
    if (mask.word[x]) stretch(0, x);
  }
  for (int i = 0; i < 8; ++i) {
    if (all >> (8 * i) & 255) stretch(1, i);
    if (all >> i & 0x0101010101010101ull) stretch(2, i);
  }
  leaf.mBBoxMin = nanovdb::Coord(at.x * 8 + lo[0], at.y * 8 + lo[1], at.z * 8 + lo[2]);
  for (int axis = 0; axis < 3; ++axis) leaf.mBBoxDif[axis] = uint8_t(hi[axis] - lo[axis]);
  leaf.mFlags = kLeafFlags;
#if ISOSHELL_NANOVDB_ON_INDEX
  leaf.mOffset = first_value;
  uint64_t before = 0, packed = 0;
  for (int word = 0; word < 7; ++word) {
    before += uint64_t(popcount64(mask.word[word]));
    packed |= before << (9 * word);
  }
  leaf.mPrefixSum = packed;
#else
  leaf.mValueOff = first_value;
#endif
}

void stretch_box(Box& box, const Box& by, bool first) {
  if (first) box = by;
  for (int axis = 0; axis < 3; ++axis) {
    box[0][axis] = box[0][axis] < by[0][axis] ? box[0][axis] : by[0][axis];
    box[1][axis] = box[1][axis] > by[1][axis] ? box[1][axis] : by[1][axis];
  }
}

template <class Parent, class Child>
void adopt(Parent& parent, uint32_t slot, Child& child, const Box& child_box, bool first) {
  parent.mChildMask.setOn(slot);
  parent.setChild(slot, &child);
  stretch_box(parent.mBBox, child_box, first);
}

/// Writes leaves and internal nodes and links them; the boxes grow on the way.
void write_nodes(std::byte* bytes, const NanoLayout& at, const VoxelSet& voxels) {
  auto* root = reinterpret_cast<Root*>(bytes + at.root);
  auto* uppers = reinterpret_cast<Upper*>(bytes + at.first_upper);
  auto* lowers = reinterpret_cast<Lower*>(bytes + at.first_lower);
  auto* leaves = reinterpret_cast<Leaf*>(bytes + at.first_leaf);
  int64_t u = -1, w = -1;
  uint64_t previous = 0;
  for (int64_t l = 0; l < at.leaves; ++l) {
    const uint64_t key = voxels.leaf_key[l];
    const bool new_lower = l == 0 || lower_of_key(key) != lower_of_key(previous);
    const bool new_upper = l == 0 || upper_of_key(key) != upper_of_key(previous);
    previous = key;
    u += new_upper;
    w += new_lower;
    Leaf& leaf = leaves[l];
    const Voxel origin = leaf_of_key(key);
    write_leaf(leaf, origin, voxels.mask[l], uint64_t(voxels.first[l]) + 1);
    const nanovdb::Coord lo = leaf.mBBoxMin;
    const Box box(lo, nanovdb::Coord(lo[0] + leaf.mBBoxDif[0], lo[1] + leaf.mBBoxDif[1], lo[2] + leaf.mBBoxDif[2]));
    adopt(lowers[w], uint32_t(key & 4095), leaf, box, new_lower);
    adopt(uppers[u], uint32_t(key >> 12) & 32767, lowers[w], box, new_upper);
    stretch_box(root->mBBox, box, l == 0);
  }
}

void write_root(std::byte* bytes, const NanoLayout& at, const uint64_t* upper_key) {
  auto* root = reinterpret_cast<Root*>(bytes + at.root);
  for (int64_t u = 0; u < at.uppers; ++u) {
    const Voxel leaf = leaf_of_key(upper_key[u] << 27);
    auto* upper = reinterpret_cast<nanovdb::NanoUpper<BuildType>*>(bytes + at.first_upper + u * int64_t(sizeof(Upper)));
    root->tile(root->mTableSize++)->setChild(nanovdb::Coord(leaf.x * 8, leaf.y * 8, leaf.z * 8), upper, root);
  }
  if (at.leaves == 0) root->mBBox = Box();
}

void write_tree(std::byte* bytes, const NanoLayout& at) {
  auto* tree = reinterpret_cast<Tree*>(bytes + sizeof(Grid));
  const int64_t start = int64_t(sizeof(Grid));
  const int64_t node[4] = {at.first_leaf, at.first_lower, at.first_upper, at.root};
  const int64_t count[3] = {at.leaves, at.lowers, at.uppers};
  for (int level = 0; level < 4; ++level)
    tree->mNodeOffset[level] = decltype(tree->mNodeOffset[0] + 0)(node[level] - start);
  for (int level = 0; level < 3; ++level) tree->mNodeCount[level] = uint32_t(count[level]);
#if !ISOSHELL_NANOVDB_ON_INDEX
  if (at.leaves == 0) tree->mNodeOffset[0] = tree->mNodeOffset[1] = tree->mNodeOffset[2] = 0;
#endif
  tree->mVoxelCount = uint64_t(at.voxels);
}

/// Index (i, j, k) is the centre of voxel (i, j, k).
void write_map(Grid& grid, const LatticeFrame& frame) {
  grid.mMap.set(frame.voxel_size, nanovdb::Vec3d(nano_shift(frame, 0), nano_shift(frame, 1), nano_shift(frame, 2)),
                1.0);
  for (int axis = 0; axis < 3; ++axis) grid.mVoxelSize[axis] = frame.voxel_size;
}

/// The world box is that of index box lo .. hi + 1, as NanoVDB has it.
void write_world_box(Grid& grid, const Box& box, const LatticeFrame& frame) {
  for (int axis = 0; axis < 3; ++axis) {
    grid.mWorldBBox[0][axis] = nano_shift(frame, axis) + frame.voxel_size * box[0][axis];
    grid.mWorldBBox[1][axis] = nano_shift(frame, axis) + frame.voxel_size * (box[1][axis] + 1.0);
  }
}
void write_empty_world_box(Grid& grid) {
  const double furthest = std::numeric_limits<double>::max();
  for (int axis = 0; axis < 3; ++axis) {
    grid.mWorldBBox[0][axis] = furthest;
    grid.mWorldBBox[1][axis] = -furthest;
  }
}

void write_grid(std::byte* bytes, const NanoLayout& at, const LatticeFrame& frame, const char* name) {
  auto* grid = reinterpret_cast<Grid*>(bytes);
#ifdef NANOVDB_USE_NEW_MAGIC_NUMBERS
  grid->mMagic = NANOVDB_MAGIC_GRID;
#else
  grid->mMagic = 0x304244566f6e614eull;  // "NanoVDB0"
#endif
  std::memset(static_cast<void*>(&grid->mChecksum), 0xff, sizeof grid->mChecksum);  // none: the products carry digests
  grid->mVersion = nanovdb::Version();
  const uint32_t flags =
      uint32_t(nanovdb::GridFlags::IsBreadthFirst) | (at.leaves ? uint32_t(nanovdb::GridFlags::HasBBox) : 0);
  std::memcpy(static_cast<void*>(&grid->mFlags), &flags, sizeof flags);
  grid->mGridCount = 1;
  grid->mGridSize = uint64_t(at.end);
  std::memcpy(grid->mGridName, name, std::strlen(name));
  grid->mGridClass = nanovdb::GridClass::IndexGrid;
  grid->mGridType = kGridType;
#if ISOSHELL_NANOVDB_ON_INDEX
  grid->mBlindMetadataOffset = at.end;
#endif
  grid->mData1 = uint64_t(at.voxels) + 1;  // values indexed, with the background
#if ISOSHELL_NANOVDB_ON_INDEX && !defined(NANOVDB_USE_NEW_MAGIC_NUMBERS)
  grid->mData2 = NANOVDB_MAGIC_GRID;
#endif
  write_map(*grid, frame);
  if (at.leaves == 0) write_empty_world_box(*grid);
}

void require_name_fits(const char* name) {
  if (std::strlen(name) >= Grid::MaxNameSize)
    throw Error(ErrorCode::usage, "nano_shell",
                "the grid's name has " + std::to_string(std::strlen(name)) + " characters; it must have at most 255");
}

void write_head(std::byte* bytes, const NanoLayout& at, const uint64_t* upper_key, const LatticeFrame& frame,
                const char* name) {
  write_root(bytes, at, upper_key);
  write_tree(bytes, at);
  write_grid(bytes, at, frame, name);
}

template <class Node>
NanoNode fields_of() {
  return {int64_t(sizeof(Node)), int64_t(offsetof(Node, mBBox)), int64_t(offsetof(Node, mChildMask)),
          int64_t(offsetof(Node, mTable))};
}

}  // namespace

NanoNodes nano_nodes() {
#if ISOSHELL_NANOVDB_ON_INDEX
  constexpr int64_t kFirstValue = int64_t(offsetof(Leaf, mOffset));
#else
  constexpr int64_t kFirstValue = int64_t(offsetof(Leaf, mValueOff));
#endif
  static_assert(offsetof(Leaf, mValueMask) == kNanoLeafMask && sizeof(Leaf) == kNanoLeafBytes, "unknown leaf layout");
  return {fields_of<Upper>(), fields_of<Lower>(), kLeafFlags, int((kFirstValue - kNanoLeafWords) / 8),
          ISOSHELL_NANOVDB_ON_INDEX == 1};
}

NanoLayout nano_layout(int64_t leaves, int64_t lowers, int64_t uppers, int64_t voxels) {
  NanoLayout at;
  at.leaves = leaves;
  at.lowers = lowers;
  at.uppers = uppers;
  at.voxels = voxels;
  at.root = int64_t(sizeof(Grid) + sizeof(Tree));
  at.first_upper = at.root + int64_t(sizeof(Root)) + uppers * int64_t(sizeof(Root::Tile));
  at.first_lower = at.first_upper + uppers * int64_t(sizeof(Upper));
  at.first_leaf = at.first_lower + lowers * int64_t(sizeof(Lower));
  at.end = at.first_leaf + leaves * int64_t(sizeof(Leaf));
  at.root_box = at.root + int64_t(offsetof(Root, mBBox));
  at.world_box = int64_t(offsetof(Grid, mWorldBBox));
  return at;
}

double nano_shift(const LatticeFrame& frame, int axis) {
  const double origin = axis == 0 ? frame.origin.x : axis == 1 ? frame.origin.y : frame.origin.z;
  return origin + 0.5 * frame.voxel_size;
}

Buffer<std::byte> nano_head(const NanoLayout& at, const uint64_t* upper_key, const LatticeFrame& frame,
                            const char* name) {
  if (!name) name = "";
  require_name_fits(name);
  Buffer<std::byte> bytes(at.first_upper);
  std::memset(bytes.data(), 0, size_t(at.first_upper));
  write_head(bytes.data(), at, upper_key, frame, name);
  return bytes;
}

Buffer<std::byte> nano_index_grid(const VoxelSet& voxels, const LatticeFrame& frame, const char* name) {
  if (!name) name = "";
  require_name_fits(name);
  std::vector<uint64_t> upper_key;
  const NanoLayout at = lay_out(voxels, upper_key);
  Buffer<std::byte> bytes(at.end);
  std::memset(bytes.data(), 0, size_t(at.end));
  write_head(bytes.data(), at, upper_key.data(), frame, name);
  write_nodes(bytes.data(), at, voxels);
  if (at.leaves > 0)
    write_world_box(*reinterpret_cast<Grid*>(bytes.data()), reinterpret_cast<Root*>(bytes.data() + at.root)->mBBox,
                    frame);
  return bytes;
}

}  // namespace isoshell
