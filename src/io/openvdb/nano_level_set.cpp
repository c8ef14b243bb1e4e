// A level set as a grid of NanoVDB, by NanoVDB's own conversion.
#include <openvdb/openvdb.h>
#if __has_include(<nanovdb/tools/CreateNanoGrid.h>)
#define NANOVDB_USE_OPENVDB
#include <nanovdb/tools/CreateNanoGrid.h>
#else
#include <nanovdb/util/OpenToNanoVDB.h>
#endif

#include <cstring>

#include "isoshell/openvdb.h"

namespace isoshell {

Buffer<std::byte> nano_level_set(const LevelSet& level_set, const std::string& name) {
  const openvdb::FloatGrid::Ptr grid = to_openvdb(level_set, {name, false, false});
#if __has_include(<nanovdb/tools/CreateNanoGrid.h>)
  const auto handle = nanovdb::tools::createNanoGrid(*grid);
#else
  const auto handle = nanovdb::openToNanoVDB(*grid);
#endif
  Buffer<std::byte> bytes(int64_t(handle.size()));
  std::memcpy(bytes.data(), handle.data(), size_t(bytes.size()));
  return bytes;
}

}  // namespace isoshell
