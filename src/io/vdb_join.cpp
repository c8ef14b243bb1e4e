// Joins separately written grids into one .vdb file.
#include "io/vdb_join.h"

#include <openvdb/io/Archive.h>
#include <openvdb/openvdb.h>
#include <tbb/parallel_for.h>

#include <cstring>
#include <filesystem>
#include <fstream>

#include "io/vdb_layout.h"
#include "io/vdb_streams.h"
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

void write_bytes(const std::string& path, const std::vector<char>& bytes, bool overwrite) {
  if (!overwrite && std::filesystem::exists(path))
    throw Error(ErrorCode::unwritable_output, "write", path + ": exists; ask for overwriting to replace it");
  const std::string temporary = path + ".part";
  std::ofstream out(temporary, std::ios::binary);
  out.write(bytes.data(), std::streamsize(bytes.size()));
  out.close();
  std::error_code failed;
  if (out) std::filesystem::rename(temporary, path, failed);
  if (!out || failed) {
    std::filesystem::remove(temporary, failed);
    throw Error(ErrorCode::unwritable_output, "write", path + ": cannot be written; check the folder and the free space");
  }
}

}  // namespace

void initialize_openvdb() { openvdb::initialize(); }

void write_vdb_file(const std::string& path, const std::vector<std::function<openvdb::GridBase::Ptr()>>& makers,
                    const openvdb::MetaMap& meta, bool overwrite) {
  const StreamArchive archive;
  std::vector<std::vector<char>> parts(makers.size());
  tbb::parallel_for(size_t(0), makers.size(), [&](size_t i) { parts[i] = archive.bytes({makers[i]()}, {}); });

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
  write_bytes(path, file, overwrite);
}

}  // namespace isoshell
