// The only file that knows NanoVDB's node layout: index grids from sorted leaves.
#include "isoshell/error.h"
#include "isoshell/shell.h"

namespace isoshell {

Buffer<std::byte> nano_index_grid(const VoxelSet&, const LatticeFrame&, const char*) {
  throw Error(ErrorCode::internal, "nano_shell", "nano_index_grid is missing");
}

}  // namespace isoshell
