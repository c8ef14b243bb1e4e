// Sparse grids in memory as inputs: those of OpenVDB (isoshell/openvdb.h), of NanoVDB (isoshell/nanovdb.h), and arrays
// of voxels and values of everybody else.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/level_set.h"
#include "isoshell/io/input.h"

namespace isoshell {

class HeldGrid;  // of the library

/// A grid that a run can start from. Copies share it.
class MemoryGrid {
 public:
  explicit MemoryGrid(std::shared_ptr<const HeldGrid> held) : held_(std::move(held)) {}
  const HeldGrid& held() const { return *held_; }

 private:
  std::shared_ptr<const HeldGrid> held_;
};

/// Values at some voxels of a lattice. Voxel (i, j, k) has its value at origin + i step[0] + j step[1] + k step[2], and
/// i, j and k may be negative. Borrows both arrays.
struct SparseVolume {
  View<const Voxel> voxels;  ///< in any order, each once
  View<const float> values;  ///< one a voxel; NaN where nothing is known
  double background = 0;     ///< of all other voxels
  /// Whether the values are signed distances, negative inside: then voxels that are not given, but enclosed by negative
  /// ones, have the negative of the background.
  bool is_level_set = false;
  std::array<WorldPoint, 3> step_world{WorldPoint{1, 0, 0}, WorldPoint{0, 1, 0}, WorldPoint{0, 0, 1}};
  WorldPoint origin_world{0, 0, 0};
};

/// A copy of the values as a grid. `name` is what messages call the volume. Cost: a sort of the voxels, and 2 KiB for
/// each block of 8^3 that has one. Throws: usage for no voxel, another number of values than of voxels, a voxel that is
/// given twice or 2^30 or farther from the origin, an infinite value, a background that is not finite, of a level set
/// one that is not above 0 or no value that is 0 or above, and steps that span no volume or have no inverse;
/// out_of_memory where the grid would take more than the limit in bytes (0: none); unreadable_input in a build without
/// OpenVDB.
MemoryGrid sparse_grid(const SparseVolume& volume, const std::string& name, int64_t memory_limit_bytes = 0);

/// A grid of NanoVDB in its bytes, which start at a multiple of 32 in host memory and outlive all copies of the result.
/// Throws: unreadable_input for bytes that are no grid of NanoVDB; damage in them is found by input_of().
MemoryGrid nano_grid(View<const std::byte> bytes);

/// A level set as the bytes of a NanoVDB grid of floats, the one that save_level_set() writes as OpenVDB's: to save or
/// to upload. In host memory. Cost: of a conversion of the whole grid. Throws: usage where distances are missing;
/// unwritable_output in a build without OpenVDB.
Buffer<std::byte> nano_level_set(const LevelSet& level_set, const std::string& name = "surface");

/// What read_input() gives of a file of that grid alone: floats and doubles become a volume, whole numbers labels, by
/// the isovalue, the features and the labels of the request; its path, format and names of grids do not count. `name`
/// is what messages call the grid's place. Throws: nothing_to_mesh for a grid of another type; and as read_volume() and
/// read_labels() do.
Input input_of(const MemoryGrid& grid, const std::string& name, const InputRequest& request, const Context& context,
               const Tell& tell = {});

/// The grid's values for InputRequest::given_grids, under a name. Shares the grid. Cost: a hash of all its values, on
/// one thread. Throws: usage for a grid of a type that is not sampled, as those of NanoVDB (nanoToOpenVDB() converts
/// them); unreadable_input in a build without OpenVDB.
std::shared_ptr<const GridField> grid_field(const MemoryGrid& grid, const std::string& name);

/// What read_input() gives of a file of these bytes, which are those of a .vdb or .nvdb file, of a stream that OpenVDB
/// wrote, or of a handle of NanoVDB in memory, of whose grids the request names one where there are several. Borrows
/// them for the call; of a grid of NanoVDB it takes a copy. Throws: as read_input() does.
Input input_of_vdb(View<const char> bytes, const std::string& name, const InputRequest& request, const Context& context,
                   const Tell& tell = {});

}  // namespace isoshell
