// nano_index_grid: runs on the backend that the context asks for.
#include "stages/backend_table.h"

namespace isoshell {

Buffer<std::byte> nano_index_grid(const VoxelSet& voxels, const LatticeFrame& frame, const char* name,
                                  Context& context) {
  return backend_for(context).nano_index_grid(voxels, frame, name, context);
}

}  // namespace isoshell
