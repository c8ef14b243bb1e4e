// The CPU's nano_index_grid: src/grid's, on the host.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"

namespace isoshell {

Buffer<std::byte> CpuBackend::nano_index_grid(const VoxelSet& voxels, const LatticeFrame& frame, const char* name,
                                              Context&) const {
  return isoshell::nano_index_grid(*OnHost(voxels), frame, name);
}

}  // namespace isoshell
