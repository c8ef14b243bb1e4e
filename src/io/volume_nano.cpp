// Scalar grids of .nvdb files as fields: segments, each an index of its grids and then their bytes.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>

#include "grid/nano_volume.h"
#include "io/vdb/held_grid.h"
#include "io/vdb/vdb_cursor.h"
#include "io/vdb/volume_readers.h"
#include "isoshell/error.h"
#include "isoshell/io/memory_grid.h"

namespace isoshell {
namespace {

enum class Codec : uint16_t { none, zip, blosc };
constexpr int64_t kIndexBytes = 176, kGridHeadBytes = 672;
constexpr uint32_t kMajor = 32;
constexpr int64_t kBestZipRatio = 1032;

/// One grid as the file's index has it.
struct NanoGridSpan {
  VolumeGrid grid;
  int64_t begin = 0, file_bytes = 0, grid_bytes = 0;
  Codec codec{};
};

template <class T>
T value_at(const char* bytes, int64_t offset) {
  T value;
  std::memcpy(&value, bytes + offset, sizeof value);
  return value;
}

VolumeGrid about_nano(const std::string& name, const NanoKind& kind) {
  VolumeGrid grid{name, kind.type, kind.grid_class, ""};
  if (!kind.scalar) grid.flaw = "holds no numbers that have a surface; save it as float";
  return grid;
}

std::vector<NanoGridSpan> read_index(const MeshSource& source) {
  std::vector<NanoGridSpan> grids;
  VdbCursor in(source.name(), {source.begin(), source.size()}, 0);
  while (in.at() < source.size()) {
    const char* head = in.take(16, "header of a segment");
    if (std::memcmp(head, "NanoVDB", 7) != 0) in.fail("a segment does not begin with NanoVDB");
    const uint32_t version = value_at<uint32_t>(head, 8) >> 21;
    if (version != kMajor)
      throw_unreadable_vdb(source.name(), "NanoVDB format " + std::to_string(version) + " is not " +
                                              std::to_string(kMajor) + "; convert it again with another program");
    const size_t first = grids.size();
    const uint16_t count = value_at<uint16_t>(head, 12), codec = value_at<uint16_t>(head, 14);
    if (codec > uint16_t(Codec::blosc)) in.fail("unknown codec " + std::to_string(codec));
    for (uint16_t i = 0; i < count; ++i) {
      const char* index = in.take(kIndexBytes, "index of a grid");
      NanoGridSpan span;
      span.codec = Codec(codec);
      const NanoKind kind = nano_kind(value_at<uint32_t>(index, 32), value_at<uint32_t>(index, 36));
      span.grid_bytes = value_at<int64_t>(index, 0);
      span.file_bytes = value_at<int64_t>(index, 8);
      const uint32_t name_bytes = value_at<uint32_t>(index, 136);
      const char* name = in.take(name_bytes, "name of a grid");
      span.grid = about_nano(std::string(name, strnlen(name, name_bytes)), kind);
      grids.push_back(span);
    }
    for (size_t i = first; i < grids.size(); ++i) {
      grids[i].begin = in.at();
      in.take(grids[i].file_bytes, "grid");
    }
  }
  return grids;
}

/// Bytes of a grid, aligned as its nodes are.
class GridBytes {
 public:
  explicit GridBytes(int64_t size)
      : size_(size), unit_(new Unit[size_t((size + kNanoAlignment - 1) / kNanoAlignment)]) {}
  View<char> view() { return {reinterpret_cast<char*>(unit_.get()), size_}; }
  View<const std::byte> grid() const { return {reinterpret_cast<const std::byte*>(unit_.get()), size_}; }

 private:
  struct alignas(kNanoAlignment) Unit {
    char bytes[kNanoAlignment];
  };
  int64_t size_;
  std::unique_ptr<Unit[]> unit_;
};

class NanoField : public ScalarField {
 public:
  /// Of a grid in bytes that lie where the field keeps them, or outlive it.
  NanoField(const VolumeGrid& grid, View<const std::byte> bytes, std::unique_ptr<GridBytes> owned)
      : bytes_(std::move(owned)), volume_(open_nano_volume(bytes)) {
    name = grid.name;
    grid_class = grid.grid_class;
    background = volume_.background;
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) to_world.at[i][j] = volume_.matrix[3 * i + j];
      to_world.at[i][3] = volume_.shift[i];
    }
    std::sort(volume_.leaves.begin(), volume_.leaves.end(),
              [](const auto& a, const auto& b) { return before(a.origin, b.origin); });
    std::sort(volume_.tiles.begin(), volume_.tiles.end(), [](const auto& a, const auto& b) {
      return a.size != b.size ? a.size < b.size : before(a.origin, b.origin);
    });
  }

  const std::string& fault() const { return volume_.fault; }

  std::vector<Voxel> blocks() const override {
    std::vector<Voxel> origins;
    for (const NanoLeafRef& leaf : volume_.leaves) origins.push_back(leaf.origin);
    return origins;
  }
  std::vector<FieldTile> tiles() const override {
    std::vector<FieldTile> tiles;
    for (const NanoTileRef& tile : volume_.tiles) tiles.push_back({tile.origin, tile.size, tile.value});
    return tiles;
  }
  void copy(Voxel origin, const int size[3], float* to) const override {
    const auto leaf = std::lower_bound(volume_.leaves.begin(), volume_.leaves.end(), origin,
                                       [](const NanoLeafRef& a, Voxel b) { return before(a.origin, b); });
    if (leaf != volume_.leaves.end() && leaf->origin == origin) {
      if (is_band_alone())
        copy_block(size, to,
                   [&](int i) { return volume_.is_unset(leaf->leaf, i) ? NAN : volume_.value(leaf->leaf, i); });
      else
        copy_block(size, to, [&](int i) { return volume_.value(leaf->leaf, i); });
    } else {
      const float value = tile_value(origin);
      copy_block(size, to, [&](int) { return is_band_alone() && value == 0 ? NAN : value; });
    }
  }

 private:
  static bool before(Voxel a, Voxel b) { return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z; }

  float tile_value(Voxel v) const {
    for (const int32_t size : {8, 128, 4096}) {
      const Voxel origin = {v.x & -size, v.y & -size, v.z & -size};
      const auto tile = std::lower_bound(
          volume_.tiles.begin(), volume_.tiles.end(), origin,
          [&](const NanoTileRef& a, Voxel b) { return a.size != size ? a.size < size : before(a.origin, b); });
      if (tile != volume_.tiles.end() && tile->size == size && tile->origin == origin) return tile->value;
    }
    return float(background);
  }

  const std::unique_ptr<GridBytes> bytes_;  ///< null where they are another's
  NanoVolume volume_;
};

std::unique_ptr<GridBytes> unpack(const MeshSource& source, const NanoGridSpan& span) {
  const VdbCursor in(source.name(), {source.begin(), source.size()}, span.begin);
  auto grid = std::make_unique<GridBytes>(span.grid_bytes);
  const View<const char> packed{source.begin() + span.begin, span.file_bytes};
  if (span.codec == Codec::none)
    std::memcpy(grid->view().data, packed.data, size_t(span.grid_bytes));
  else if (!unpack_stream(packed, span.codec == Codec::zip, grid->view()))
    in.fail("grid \"" + span.grid.name + "\" cannot be unpacked");
  return grid;
}

[[noreturn]] void refuse_nano(const std::string& what) {
  throw Error(ErrorCode::unreadable_input, "read", "a grid of NanoVDB: " + what);
}

/// A grid of NanoVDB from memory.
class HeldNanoGrid final : public HeldGrid {
 public:
  /// Of a grid in bytes that lie where it keeps them, or outlive it.
  HeldNanoGrid(const NanoHead& head, View<const std::byte> bytes, std::unique_ptr<GridBytes> owned)
      : HeldGrid(as_volume(head), as_labels(head)), owned_(std::move(owned)), bytes_(bytes) {}
  std::unique_ptr<ScalarField> field() const override {
    auto field = std::make_unique<NanoField>(volume(), bytes_, nullptr);
    if (!field->fault().empty()) refuse_nano("grid \"" + volume().name + "\": " + field->fault());
    return field;
  }
  LabelVolume label_volume(const std::string&, const LabelReadOptions&) const override { return {}; }
  std::shared_ptr<const GridField> sampled(const std::string& name) const override {
    throw Error(ErrorCode::usage, "arguments",
                "grid " + name + " is one of NanoVDB, whose values are not sampled; convert it by nanoToOpenVDB()");
  }

 private:
  static VolumeGrid as_volume(const NanoHead& head) {
    return about_nano(head.name, nano_kind(head.grid_type, head.grid_class));
  }
  static VolumeGrid as_labels(const NanoHead& head) {
    VolumeGrid grid = as_volume(head);
    grid.flaw = "holds no labels that are read; save them in a grid of OpenVDB";
    return grid;
  }

  const std::unique_ptr<GridBytes> owned_;
  const View<const std::byte> bytes_;
};

/// A grid in bytes that are another's.
struct NanoGridBytes {
  NanoHead head;
  View<const char> bytes;

  VolumeGrid volume() const { return about_nano(head.name, nano_kind(head.grid_type, head.grid_class)); }
};

/// The grids that stand one behind another, as in a handle; none where the bytes do not begin with one.
std::vector<NanoGridBytes> grids_in_a_row(View<const char> bytes) {
  std::vector<NanoGridBytes> grids;
  for (int64_t at = 0; at < bytes.size;) {
    const View<const char> left{bytes.data + at, bytes.size - at};
    const NanoHead head = nano_head_of({reinterpret_cast<const std::byte*>(left.data), left.size});
    const bool is_grid = head.fault.empty() && head.grid_bytes >= uint64_t(kGridHeadBytes) &&
                         head.grid_bytes <= uint64_t(left.size);  // of a file a hash of the grid's name is here
    if (!is_grid) break;
    grids.push_back({head, {left.data, int64_t(head.grid_bytes)}});
    at += int64_t(head.grid_bytes);
  }
  return grids;
}

std::vector<VolumeGrid> grids_of(const std::vector<NanoGridSpan>& spans) {
  std::vector<VolumeGrid> grids;
  for (const NanoGridSpan& span : spans) grids.push_back(span.grid);
  return grids;
}

}  // namespace

std::vector<VolumeGrid> nano_grids(const MeshSource& source) { return grids_of(read_index(source)); }

std::unique_ptr<ScalarField> read_nano_volume(const MeshSource& source, const VolumeReadOptions& options) {
  const std::vector<NanoGridSpan> spans = read_index(source);
  const NanoGridSpan& span = spans[choose_grid(source.name(), grids_of(spans), options)];
  const int64_t most = span.codec == Codec::none ? span.file_bytes : span.file_bytes * kBestZipRatio;
  if (span.grid_bytes < kGridHeadBytes || span.grid_bytes > most)
    throw_unreadable_vdb(source.name(), "grid \"" + span.grid.name + "\" says that its " +
                                            std::to_string(span.file_bytes) + " bytes hold " +
                                            std::to_string(span.grid_bytes) + ": the file is damaged");
  check_volume_memory(source, span.grid, span.grid_bytes, options);
  std::unique_ptr<GridBytes> bytes = unpack(source, span);
  const View<const std::byte> grid = bytes->grid();
  auto field = std::make_unique<NanoField>(span.grid, grid, std::move(bytes));
  if (!field->fault().empty())
    throw_unreadable_vdb(source.name(), "grid \"" + span.grid.name + "\": " + field->fault() + ": the file is damaged");
  return field;
}

MemoryGrid nano_grid(View<const std::byte> bytes) {
  if (reinterpret_cast<uintptr_t>(bytes.data) % uintptr_t(kNanoAlignment) != 0)
    refuse_nano("its bytes do not start at a multiple of " + std::to_string(kNanoAlignment) +
                "; copy them to where they do");
  const NanoHead head = nano_head_of(bytes);
  if (!head.fault.empty()) refuse_nano(head.fault);
  return MemoryGrid(std::make_shared<HeldNanoGrid>(head, bytes, nullptr));
}

std::shared_ptr<const HeldGrid> copied_nano_grid(View<const char> bytes, const std::string& name,
                                                 const VolumeReadOptions& options) {
  const std::vector<NanoGridBytes> grids = grids_in_a_row(bytes);
  if (grids.empty()) return nullptr;
  const MeshSource source(name, bytes);
  std::vector<VolumeGrid> about;
  for (const NanoGridBytes& grid : grids) about.push_back(grid.volume());
  const size_t chosen = grids.size() == 1 ? 0 : choose_grid(name, about, options);
  const View<const char> of = grids[chosen].bytes;
  check_volume_memory(source, about[chosen], of.size, options);
  auto copy = std::make_unique<GridBytes>(of.size);
  std::memcpy(copy->view().data, of.data, size_t(of.size));
  const View<const std::byte> grid = copy->grid();
  return std::make_shared<HeldNanoGrid>(grids[chosen].head, grid, std::move(copy));
}

}  // namespace isoshell
