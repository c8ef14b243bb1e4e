// Grids of OpenVDB in memory: as inputs, and of what was made. This is the only public header that includes OpenVDB, so
// isoshell.h does not include it: programs that do link isoshell::openvdb. It must be the OpenVDB that isoshell was
// built with.
#pragma once

#include <openvdb/openvdb.h>

#include "isoshell/advanced/level_set.h"
#include "isoshell/advanced/shell.h"
#include "isoshell/io/memory_grid.h"
#include "isoshell/io/vdb_file.h"

namespace isoshell {

/// A grid to start from, by input_of(): a level set, a fog volume or distances of FloatGrid and DoubleGrid, labels of
/// Int32Grid and Int64Grid. What is made of it is, bit for bit, what is made of a file that has its values in full, not
/// as half floats. Shares the tree, which must not change meanwhile. Throws: unreadable_input for a transform that is
/// not linear. A grid of another type is refused by input_of().
MemoryGrid read_grid(const openvdb::GridBase& grid);

/// The grid that save_level_set() writes: in world units, from voxel centres, with a sign everywhere. Of a level set on
/// a device it takes a copy. Cost: linear in the voxels, on all threads. Throws: usage where distances are
/// missing; and as check_level_set_write() does.
openvdb::FloatGrid::Ptr to_openvdb(const LevelSet& level_set, const LevelSetWriteOptions& options = {});

/// A shell as the stage file has it: the FloatGrid "shell_distance", from voxel centre to voxel centre in world units,
/// and the Int32Grids "closest_site" and "distance_sq_vox". `frame` is that of the surface. Throws: usage
/// where values are missing.
openvdb::GridPtrVec to_openvdb(const Shell& shell, const LatticeFrame& frame);

}  // namespace isoshell
