// What needs no OpenVDB: recognising a stage file, and what values of 16 bits hold.
#include "isoshell/io/vdb_file.h"

#include <filesystem>
#include <fstream>

#include "io/vdb/stage_reader.h"
#include "io/vdb/vdb_cursor.h"
#include "io/vdb/vdb_format.h"
#include "io/vdb/vdb_layout.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

// Of numbers of 16 bits. Below the least one that has all its bits, numbers are 2^-24 apart.
constexpr double kLargestHalf = 65504, kLeastWholeHalf = 1. / 16384;

}  // namespace

void check_level_set_write(const LevelSet& level_set, const LevelSetWriteOptions& options) {
  const double band_world = level_set.band_vox * level_set.frame.voxel_size;
  if (!options.as_half || (band_world >= kLeastWholeHalf && band_world <= kLargestHalf)) return;
  throw Error(ErrorCode::usage, "write",
              "the level set's band is " + readable_length(band_world) +
                  " world units wide, and values of 16 bits hold bands from 6.1e-05 to 65504; leave out "
                  "--level-set-half, or scale the input");
}

Buffer<char> read_file_start(const std::string& path, int64_t max_bytes) {
  std::error_code failed;
  if (!std::filesystem::is_regular_file(path, failed))
    throw_unreadable_vdb(path, "is not a file that can be read; check the name");
  std::ifstream in(path, std::ios::binary | std::ios::ate);
  const int64_t size = in ? int64_t(in.tellg()) : -1;
  if (size < 0) throw_unreadable_vdb(path, "cannot be opened; check its permissions");
  Buffer<char> bytes(std::min(size, max_bytes));
  in.seekg(0);
  if (!bytes.empty() && !in.read(bytes.data(), std::streamsize(bytes.size())))
    throw_unreadable_vdb(
        path, "only " + std::to_string(in.gcount()) + " of " + std::to_string(size) + " bytes could be read");
  return bytes;
}

bool holds_stage(View<const char> bytes) {
  try {
    return read_vdb_header("", bytes).texts.count(vdb_format::kKeyStage) > 0;
  } catch (const Error&) {
    return false;
  }
}

bool is_stage_file(const std::string& path) {
  try {
    return holds_stage(read_file_start(path, vdb_format::kMaxHeaderBytes).view());
  } catch (const std::exception&) {
    return false;
  }
}

}  // namespace isoshell
