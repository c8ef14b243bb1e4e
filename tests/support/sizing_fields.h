// Sizing fields as .vdb files.
#pragma once

#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

#include <functional>
#include <string>

namespace isoshell {

using LengthAt = std::function<double(const openvdb::Vec3d&)>;

/// A float grid over the box from -side to side, lengths in its active voxels.
inline openvdb::FloatGrid::Ptr sizing_grid(const std::string& name, double side, double voxel, double background,
                                           const LengthAt& length) {
  openvdb::initialize();
  auto grid = openvdb::FloatGrid::create(float(background));
  grid->setName(name);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(voxel));
  const int n = int(side / voxel) + 1;
  auto out = grid->getAccessor();
  for (int x = -n; x <= n; ++x)
    for (int y = -n; y <= n; ++y)
      for (int z = -n; z <= n; ++z) {
        const openvdb::Coord at(x, y, z);
        const double here = length(grid->indexToWorld(at));
        if (here != 0) out.setValue(at, float(here));
      }
  return grid;
}

inline void write_grids(const std::string& path, const openvdb::GridPtrVec& grids) {
  openvdb::io::File file(path);
  file.write(grids);
  file.close();
}

/// Edges on a ball of radius 1 that grow along z, from `shortest` at the bottom to `ratio` times that at the top.
inline openvdb::FloatGrid::Ptr ball_sizing(double shortest, double ratio) {
  return sizing_grid("edge_length", 1.2, 0.05, -1, [=](const openvdb::Vec3d& p) {
    return shortest * (1 + (ratio - 1) * std::max(0., p.z() + 1) / 2);
  });
}

}  // namespace isoshell
