// The values of a dense volume, and where they stand, as OpenVDB has them.
#pragma once

#include <openvdb/openvdb.h>

#include <string>

#include "io/openvdb/grid_map.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "isoshell/io/memory_input.h"

namespace isoshell {

inline float value_of(const DenseVolume& volume, int64_t i, int64_t j, int64_t k) {
  return volume.values[i * volume.stride[0] + j * volume.stride[1] + k * volume.stride[2]];
}

/// A grid whose active voxels are those of the lattice for which read(i, j, k, value) gives a value, not false. Throws:
/// as transform_of.
template <class Grid, class Read>
typename Grid::Ptr dense_grid(const DenseVolume& lattice, const std::string& name, Read read) {
  using Value = typename Grid::ValueType;
  initialize_openvdb();
  auto grid = new_vdb_grid<Grid>(name.c_str(), Value(0));
  grid->setTransform(transform_of(lattice.step_world, lattice.origin_world, name));
  auto voxels = grid->getAccessor();
  for (int64_t i = 0; i < lattice.size[0]; ++i)
    for (int64_t j = 0; j < lattice.size[1]; ++j)
      for (int64_t k = 0; k < lattice.size[2]; ++k)
        if (Value value; read(i, j, k, value)) voxels.setValueOn(openvdb::Coord(int(i), int(j), int(k)), value);
  return grid;
}

}  // namespace isoshell
