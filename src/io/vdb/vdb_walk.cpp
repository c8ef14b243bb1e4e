// A dry run through the tree of a grid as it lies in a file: root, two levels of internal nodes, leaf masks, leaf
// values.
#include <algorithm>
#include <array>

#include "io/vdb/vdb_cursor.h"
#include "io/vdb/vdb_layout.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace {

constexpr uint32_t kZip = 1, kActiveMask = 2, kBlosc = 4;
constexpr int64_t kBloscHeaderBytes = 16, kPaddedBytes = 128;
constexpr int64_t kCoordBytes = 12;
constexpr int64_t kLeafBytes = 192, kNodeBytes = 10240;  // beside their values: masks, allocation

/// How values are stored in front of a block: see OpenVDB's io/Compression.h for the meaning of 0 to 6.
struct InactiveCode {
  int values;      // stored inactive values
  bool selection;  // a second mask follows
};
constexpr InactiveCode kInactive[] = {{0, false}, {0, false}, {1, false}, {0, true}, {1, true}, {2, true}, {0, false}};
constexpr int kAllValues = 6;

struct ValueType {
  const char* name;
  int64_t bytes;
  int64_t half_bytes;     // in a grid saved as half
  int masks_of_leaf = 0;  // in place of values: which voxels are active, and for bool a second one, which are true
};
constexpr ValueType kTypes[] = {
    {"Tree_float_5_4_3", 4, 2},   {"Tree_double_5_4_3", 8, 2},  {"Tree_int32_5_4_3", 4, 4},
    {"Tree_int64_5_4_3", 8, 8},   {"Tree_vec3s_5_4_3", 12, 6},  {"Tree_vec3d_5_4_3", 24, 6},
    {"Tree_vec3i_5_4_3", 12, 12}, {"Tree_bool_5_4_3", 1, 1, 2}, {"Tree_mask_5_4_3", 1, 1, 1}};
constexpr char kHalfSuffix[] = "_HalfFloat";

class TreeWalk {
 public:
  TreeWalk(const std::string& path, View<const char> bytes, const VdbGridSpan& grid)
      : in_(path, {bytes.data, grid.end}, grid.transform), is_instance_(grid.instance), compression_(grid.compression) {
    for (const ValueType& type : kTypes) {
      const bool is_half = grid.type == std::string(type.name) + kHalfSuffix;
      if (grid.type != type.name && !is_half) continue;
      value_bytes_ = type.bytes;
      stored_bytes_ = is_half ? type.half_bytes : type.bytes;
      masks_of_leaf_ = type.masks_of_leaf;
    }
    if (value_bytes_ == 0 && !is_instance_)
      throw_unreadable_vdb(path,
                           "grid \"" + grid.name + "\" is of type " + grid.type +
                               ", which is not read; in a stream nothing tells where it ends: leave it out, or write "
                               "a file, which has offsets");
    if (compression_ > (kZip | kActiveMask | kBlosc)) in_.fail("unknown compression " + std::to_string(compression_));
  }

  VdbTreeExtent run() {
    skip_transform();
    if (is_instance_) return {0, in_.at()};
    if (in_.value<uint32_t>("count of buffers") != 1) in_.fail("a tree must have one buffer");
    in_.take(value_bytes_, "background");
    const uint32_t tiles = in_.value<uint32_t>("count of tiles"), children = in_.value<uint32_t>("count of nodes");
    in_.take(int64_t(tiles) * (kCoordBytes + value_bytes_ + 1), "tiles");
    for (uint32_t i = 0; i < children; ++i) {
      in_.take(kCoordBytes, "origin of a node");
      walk_node<5>();
      ++uppers_;
    }
    for (int64_t l = 0; l < leaves_; ++l) walk_leaf();
    const int64_t leaf_bytes = 512 * value_bytes_ + kLeafBytes, tile_bytes = std::max<int64_t>(value_bytes_, 8);
    return {
        leaves_ * leaf_bytes + lowers_ * (4096 * tile_bytes + kNodeBytes) + uppers_ * (32768 * tile_bytes + kNodeBytes),
        in_.at()};
  }

 private:
  void skip_transform() {
    const std::string type = in_.text("type of a transform");
    constexpr std::array<std::pair<const char*, int>, 6> kMaps = {{{"UniformScaleMap", 15},
                                                                   {"ScaleMap", 15},
                                                                   {"UniformScaleTranslateMap", 18},
                                                                   {"ScaleTranslateMap", 18},
                                                                   {"TranslationMap", 3},
                                                                   {"AffineMap", 16}}};
    const auto map = std::find_if(kMaps.begin(), kMaps.end(), [&](const auto& m) { return type == m.first; });
    if (map == kMaps.end()) in_.fail("unknown transform \"" + type + "\"; only linear ones are read");
    in_.take(map->second * int64_t(sizeof(double)), "transform");
  }

  View<const char> mask(int64_t bits) { return {in_.take(bits / 8, "mask"), bits / 8}; }
  static int64_t count_on(View<const char> mask) {
    int64_t count = 0;
    for (int64_t i = 0; i < mask.size; i += 8) {
      uint64_t word;
      std::memcpy(&word, mask.data + i, 8);
      count += popcount64(word);
    }
    return count;
  }

  template <int kLog2>
  void walk_node() {
    constexpr int64_t kBits = int64_t(1) << (3 * kLog2);
    const int64_t children = count_on(mask(kBits));
    walk_values(kBits, count_on(mask(kBits)));
    for (int64_t c = 0; c < children; ++c) {
      if constexpr (kLog2 == 5)
        walk_node<4>(), ++lowers_;
      else
        mask(512), ++leaves_;
    }
  }

  void walk_leaf() {
    const View<const char> active = mask(512);
    if (masks_of_leaf_ == 0) return walk_values(512, count_on(active));
    in_.take(kCoordBytes, "origin of a leaf");
    if (masks_of_leaf_ == 2) mask(512);
  }

  void walk_values(int64_t count, int64_t active) {
    const uint8_t code = in_.value<uint8_t>("code of inactive values");
    if (code > kAllValues) in_.fail("unknown code " + std::to_string(code) + " of inactive values");
    in_.take(kInactive[code].values * value_bytes_, "inactive values");  // never as half
    if (kInactive[code].selection) mask(count);
    walk_block((compression_ & kActiveMask) && code != kAllValues ? active : count);
  }

  /// Plain values, or the number of compressed bytes and those; a number not above 0 says that they are plain.
  void walk_block(int64_t count) {
    const int64_t plain_bytes = count * stored_bytes_;
    if (stored_bytes_ != value_bytes_ && count == 0) return;
    if (!(compression_ & (kZip | kBlosc))) {
      in_.take(plain_bytes, "values");
      return;
    }
    const int64_t packed_bytes = in_.value<int64_t>("size of values");
    if (packed_bytes <= 0) {
      if (packed_bytes != -plain_bytes)
        in_.fail("values take " + std::to_string(packed_bytes) + " bytes where " + std::to_string(-plain_bytes) +
                 " are due");
      in_.take(plain_bytes, "values");
      return;
    }
    const char* packed = in_.take(packed_bytes, "values");
    if (compression_ & kBlosc) check_blosc(packed, packed_bytes, plain_bytes);
  }

  /// Blosc believes the sizes in its own header. OpenVDB pads short arrays before it packs them.
  void check_blosc(const char* packed, int64_t packed_bytes, int64_t plain_bytes) {
    uint32_t sizes[3] = {};  // of the plain data, of a block, of the packed data
    if (packed_bytes >= kBloscHeaderBytes) std::memcpy(sizes, packed + 4, sizeof sizes);
    if ((sizes[0] != plain_bytes && sizes[0] != std::max(plain_bytes, kPaddedBytes)) || sizes[2] != packed_bytes)
      in_.fail("packed values of " + std::to_string(packed_bytes) + " bytes for " + std::to_string(plain_bytes) +
               " say that they are " + std::to_string(sizes[2]) + " for " + std::to_string(sizes[0]));
  }

  VdbCursor in_;
  bool is_instance_;
  uint32_t compression_;
  int masks_of_leaf_ = 0;
  int64_t value_bytes_ = 0, stored_bytes_ = 0, leaves_ = 0, lowers_ = 0, uppers_ = 0;
};

}  // namespace

VdbTreeExtent walk_vdb_tree(const std::string& path, View<const char> bytes, const VdbGridSpan& grid) {
  return TreeWalk(path, bytes, grid).run();
}

int64_t check_vdb_tree(const std::string& path, View<const char> bytes, const VdbGridSpan& grid) {
  const VdbTreeExtent tree = walk_vdb_tree(path, bytes, grid);
  if (tree.end != grid.end)
    throw_unreadable_vdb(path, "byte " + std::to_string(tree.end) + ": grid \"" + grid.name + "\" goes on for " +
                                   std::to_string(grid.end - tree.end) + " bytes after its tree; the file is damaged");
  return tree.memory_bytes;
}

}  // namespace isoshell
