// Grids to bytes and back.
#include "io/openvdb/vdb_stream.h"

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

#include <cstring>
#include <sstream>

#include "core/parallel_ranges.h"
#include "io/bytes/memory_stream.h"
#include "io/bytes/output_file.h"
#include "io/openvdb/grid_map.h"
#include "io/vdb/vdb_cursor.h"
#include "io/vdb/vdb_layout.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

/// Opens Archive's writing to any stream; io::File writes to a name only and io::Stream leaves the offsets out.
class StreamArchive : public openvdb::io::Archive {
 public:
  StreamArchive() {
    setCompression((hasBloscCompression() ? openvdb::io::COMPRESS_BLOSC : openvdb::io::COMPRESS_ZIP) |
                   openvdb::io::COMPRESS_ACTIVE_MASK);
  }
  std::vector<char> bytes(const openvdb::GridCPtrVec& grids, const openvdb::MetaMap& meta) const {
    MemorySink sink;
    std::ostream out(&sink);
    out.exceptions(std::ios_base::badbit | std::ios_base::failbit);
    Archive::write(out, grids, true, meta);
    return std::move(sink.bytes());
  }
};

int64_t read_offset(const std::vector<char>& file, int64_t at) {
  int64_t value;
  std::memcpy(&value, file.data() + at, sizeof value);
  return value;
}

/// Appends the one grid of a file of its own and moves its three offsets.
void append_grid(std::vector<char>& file, const std::vector<char>& alone) {
  const VdbGridSpan grid = read_vdb_layout("grid", {alone.data(), int64_t(alone.size())}).grids.at(0);
  const int64_t move = int64_t(file.size()) - grid.begin;
  file.insert(file.end(), alone.begin() + grid.begin, alone.end());
  for (int64_t k = 1; k <= 3; ++k) {
    const int64_t offset = read_offset(alone, grid.content - 8 * k) + move;
    std::memcpy(file.data() + move + grid.content - 8 * k, &offset, sizeof offset);
  }
}

/// OpenVDB 10 reads a tag of another form wrongly and loses its place.
constexpr char kSomeTag[] = "00000000-0000-4000-8000-000000000000";

std::string raw(uint32_t value) { return std::string(reinterpret_cast<const char*>(&value), sizeof value); }
std::string raw(const std::string& text) { return raw(uint32_t(text.size())) + text; }

/// The metadata of a grid as the file would hold it if there were only texts and what the reading of values needs.
std::string metadata_bytes(const VdbGridSpan& grid) {
  std::string bytes = raw(uint32_t(grid.texts.size() + 1));
  for (const auto& [name, value] : grid.texts) bytes += raw(name) + raw(std::string("string")) + raw(value);
  const char half = grid.type.find("_HalfFloat") != std::string::npos;
  return bytes + raw(std::string("is_saved_as_half_float")) + raw(std::string("bool")) + raw(std::string(1, half));
}

/// Whether the map is one of scales, and maybe a translation, that OpenVDB reads and writes, but does not copy.
bool is_too_small(const openvdb::math::MapBase& map) {
  using namespace openvdb::math;
  constexpr double kLeastCopied = 1e-14;  // above the 3e-15 that it says, by the rounding of a product
  const bool is_of_scales = map.isType<UniformScaleMap>() || map.isType<ScaleMap>() ||
                            map.isType<UniformScaleTranslateMap>() || map.isType<ScaleTranslateMap>();
  return is_of_scales && map.voxelSize().x() * map.voxelSize().y() * map.voxelSize().z() < kLeastCopied;
}

/// One of the same type that OpenVDB copies.
openvdb::math::Transform::Ptr large_transform_like(const openvdb::math::MapBase& map) {
  using namespace openvdb::math;
  const bool is_uniform = map.isType<UniformScaleTranslateMap>() || map.isType<UniformScaleMap>();
  const bool has_translation = map.isType<UniformScaleTranslateMap>() || map.isType<ScaleTranslateMap>();
  return transform_of_scales(is_uniform ? openvdb::Vec3d(1) : openvdb::Vec3d(1, 2, 3),
                             openvdb::Vec3d(has_translation ? 1 : 0));
}

/// The file of one grid. OpenVDB copies its transform to write it: small voxels are put in the place of large ones.
std::vector<char> bytes_of(const StreamArchive& archive, const openvdb::GridBase::Ptr& grid) {
  const openvdb::math::Transform::Ptr transform = grid->transformPtr();
  const auto map = transform->baseMap();
  if (!is_too_small(*map)) return archive.bytes({grid}, {});
  grid->setTransform(large_transform_like(*map));
  std::vector<char> file = archive.bytes({grid}, {});
  std::ostringstream out;
  transform->write(out);
  const std::string bytes = out.str();
  const int64_t at = read_vdb_layout("grid", {file.data(), int64_t(file.size())}).grids.at(0).transform;
  std::memcpy(file.data() + at, bytes.data(), bytes.size());
  return file;
}

std::vector<char> join_grids(const std::vector<std::function<openvdb::GridBase::Ptr()>>& makers,
                             const openvdb::MetaMap& meta) {
  const StreamArchive archive;
  std::vector<std::vector<char>> parts(makers.size());
  for_each_index(size_t(0), makers.size(), [&](size_t i) { parts[i] = bytes_of(archive, makers[i]()); });

  std::vector<char> file = archive.bytes({}, meta);
  const auto count = static_cast<uint32_t>(parts.size());
  std::memcpy(file.data() + file.size() - sizeof count, &count, sizeof count);
  size_t total = file.size();
  for (const auto& part : parts) total += part.size();
  file.reserve(total);
  for (auto& part : parts) {
    append_grid(file, part);
    part = {};
  }
  const std::string tag = vdb_checksum_tag({file.data(), int64_t(file.size())});
  std::memcpy(file.data() + kVdbTagBegin, tag.data(), size_t(kVdbTagBytes));
  return file;
}

}  // namespace

void initialize_openvdb() { openvdb::initialize(); }

openvdb::math::Transform::Ptr lattice_transform(const LatticeFrame& frame) {
  const double half = frame.voxel_size / 2;
  return transform_of_scales(openvdb::Vec3d(frame.voxel_size),
                             {frame.origin.x + half, frame.origin.y + half, frame.origin.z + half});
}

void write_vdb_file(const std::string& path, const std::vector<std::function<openvdb::GridBase::Ptr()>>& makers,
                    const openvdb::MetaMap& meta, bool overwrite) {
  OutputFile out(path, overwrite);
  try {
    const std::vector<char> file = join_grids(makers, meta);
    out.write(file.data(), int64_t(file.size()));
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, "write",
                path + ": out of memory while packing its grids; lower the resolution");
  } catch (const openvdb::Exception& error) {
    throw Error(ErrorCode::unwritable_output, "write", path + ": OpenVDB does not write its grids: " + error.what());
  }
  out.commit();
}

// A file of one grid: header, no metadata, the count 1, then the grid's descriptor, compression, transform and tree as
// they are. Its metadata is written anew, texts only: OpenVDB writes past a value whose size in the file is wrong.
openvdb::GridBase::Ptr read_vdb_grid(const std::string& path, View<const char> bytes, const VdbGridSpan& grid) {
  check_vdb_tree(path, bytes, grid);
  uint32_t format;
  std::memcpy(&format, bytes.data + sizeof(int64_t), sizeof format);
  if (format > openvdb::OPENVDB_FILE_VERSION)
    throw_unreadable_vdb(path, ".vdb format " + std::to_string(format) + " is newer than " +
                                   std::to_string(openvdb::OPENVDB_FILE_VERSION) +
                                   ", the newest that this build reads");
  const std::string head = std::string(bytes.data, size_t(kVdbTagBegin)) + kSomeTag + raw(uint32_t(0)) +
                           raw(uint32_t(1)) + std::string(bytes.data + grid.begin, size_t(grid.content - grid.begin)) +
                           raw(grid.compression) + metadata_bytes(grid);
  MemorySource source({head.data(), int64_t(head.size())}, {bytes.data + grid.transform, grid.end - grid.transform});
  std::istream in(&source);
  in.exceptions(std::ios_base::badbit | std::ios_base::failbit | std::ios_base::eofbit);
  try {
    const openvdb::GridPtrVecPtr grids = openvdb::io::Stream(in, false).getGrids();
    if (grids && grids->size() == 1 && (*grids)[0]) return (*grids)[0];
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::ios_base::failure&) {
    throw_unreadable_vdb(path, "grid \"" + grid.name + "\" is longer than its bytes: the file is damaged");
  } catch (const std::exception& error) {
    throw_unreadable_vdb(path, "grid \"" + grid.name + "\" cannot be read: " + error.what());
  }
  throw_unreadable_vdb(path, "grid \"" + grid.name + "\" cannot be read");
}

}  // namespace isoshell
