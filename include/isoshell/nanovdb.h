// Grids of NanoVDB in memory: as inputs, and of what was made. This is the only public header that includes NanoVDB, so
// isoshell.h does not include it: programs that do have its headers in their path. Bytes pass between them and the
// library, so that NanoVDB may be another version than isoshell's of the same major number.
#pragma once

#if __has_include(<nanovdb/GridHandle.h>)
#include <nanovdb/GridHandle.h>
#else
#include <nanovdb/util/GridHandle.h>
#endif

#include <cstring>
#include <string>

#include "isoshell/advanced/shell.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/error.h"
#include "isoshell/io/memory_grid.h"

namespace isoshell {

/// The first grid of a handle to start from, by input_of(): floats, doubles, or packed floats of Fp4 to FpN. Borrows
/// the handle's bytes in host memory, without a copy: handle.deviceDownload() brings a device's there. Throws: usage
/// for a handle without bytes in host memory; and as nano_grid().
template <class BufferT>
MemoryGrid read_grid(const nanovdb::GridHandle<BufferT>& handle) {
  if (!handle.data())
    throw Error(ErrorCode::usage, "arguments",
                "a handle of NanoVDB has no grid in host memory; call deviceDownload() for one on a device");
  return nano_grid({reinterpret_cast<const std::byte*>(handle.data()), int64_t(handle.size())});
}

/// A handle with a copy of a grid's bytes, as nano_index_grid() and nano_level_set() give them, in host memory.
inline nanovdb::GridHandle<nanovdb::HostBuffer> nano_handle(const Buffer<std::byte>& bytes) {
  nanovdb::HostBuffer buffer = nanovdb::HostBuffer::create(uint64_t(bytes.size()));
  std::memcpy(buffer.data(), bytes.data(), size_t(bytes.size()));
  return nanovdb::GridHandle<nanovdb::HostBuffer>(std::move(buffer));
}

/// Which voxels a shell has, as nano_index_grid() gives it: value i + 1 of the grid belongs to element i of the shell's
/// arrays. On the host.
inline nanovdb::GridHandle<nanovdb::HostBuffer> to_nanovdb(const Shell& shell, const LatticeFrame& frame,
                                                           const std::string& name = "shell") {
  if (shell.voxels.leaf_key.space() != MemorySpace::host) return to_nanovdb(to_host(shell), frame, name);
  return nano_handle(nano_index_grid(shell.voxels, frame, name.c_str()));
}

/// A level set as a grid of floats, like that of isoshell/openvdb.h: nano_level_set() in a handle, on the host.
inline nanovdb::GridHandle<nanovdb::HostBuffer> to_nanovdb(const LevelSet& level_set,
                                                           const std::string& name = "surface") {
  return nano_handle(nano_level_set(level_set, name));
}

}  // namespace isoshell
