// Where the voxels of OpenVDB's grids stand.
#pragma once

#include <openvdb/openvdb.h>

#include "io/vdb/volume_readers.h"

namespace isoshell {

/// Of a linear transform. Not by getAffineMap(), which throws where the determinant is almost 0.
inline AffineMap affine_map_of(const openvdb::GridBase& grid) {
  AffineMap result;
  const auto map = grid.transform().baseMap();
  for (int j = 0; j < 4; ++j) {
    openvdb::Vec3d axis(0.0);
    if (j < 3) axis[j] = 1;
    const openvdb::Vec3d column = j < 3 ? map->applyJacobian(axis) : map->applyMap(axis);
    for (int i = 0; i < 3; ++i) result.at[i][j] = column[i];
  }
  return result;
}

}  // namespace isoshell
