// A level set as a grid of NanoVDB, by NanoVDB's own conversion.
#include <openvdb/openvdb.h>
#if __has_include(<nanovdb/tools/CreateNanoGrid.h>)
#define NANOVDB_USE_OPENVDB
#include <nanovdb/tools/CreateNanoGrid.h>
#else
#include <nanovdb/util/OpenToNanoVDB.h>
#endif

#include <cstring>

#include "isoshell/error.h"
#include "isoshell/openvdb.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

auto converted(const openvdb::FloatGrid& grid) {
#if __has_include(<nanovdb/tools/CreateNanoGrid.h>)
  return nanovdb::tools::createNanoGrid(grid);
#else
  return nanovdb::openToNanoVDB(grid);
#endif
}

}  // namespace

Buffer<std::byte> nano_level_set(const LevelSet& level_set, const std::string& name) {
  const openvdb::FloatGrid::Ptr grid = to_openvdb(level_set, {name, false, false});
  try {
    const auto handle = converted(*grid);
    Buffer<std::byte> bytes(int64_t(handle.size()));
    std::memcpy(bytes.data(), handle.data(), size_t(bytes.size()));
    return bytes;
  } catch (const openvdb::Exception& error) {
    throw Error(ErrorCode::unwritable_output, "write",
                "NanoVDB's conversion does not take voxels of " + readable_length(level_set.frame.voxel_size) + " (" +
                    error.what() + "); scale the surface up, or write a file of OpenVDB");
  }
}

}  // namespace isoshell
