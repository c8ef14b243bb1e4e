// Level sets of simple bodies in .vdb files, for tests of several at once.
#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "isoshell/io/input.h"

namespace isoshell {

constexpr double kVoxel = 0.05;
using Distance = std::function<double(const WorldPoint&)>;

inline double norm(double x, double y, double z) { return std::sqrt(x * x + y * y + z * z); }

inline Distance ball(double x, double radius) {
  return [=](const WorldPoint& p) { return norm(p.x - x, p.y, p.z) - radius; };
}

/// From `low` to `high` along x, and as wide as .4 on both sides along y and z.
inline Distance box(double low, double high) {
  return [=](const WorldPoint& p) {
    const double x = std::abs(p.x - (low + high) / 2) - (high - low) / 2, y = std::abs(p.y) - .4,
                 z = std::abs(p.z) - .4;
    const double inside = std::min(0., std::max({x, y, z}));
    return inside + norm(std::max(x, 0.), std::max(y, 0.), std::max(z, 0.));
  };
}

inline openvdb::FloatGrid::Ptr level_set(const std::string& name, const Distance& distance, double shift = 0,
                                         double band_vox = 3) {
  openvdb::initialize();
  const double band = band_vox * kVoxel;
  constexpr int kHalf = 27;
  auto grid = openvdb::FloatGrid::create(float(band));
  grid->setName(name);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(kVoxel));
  if (shift != 0) grid->transform().postTranslate({shift, 0, 0});
  auto voxels = grid->getAccessor();
  for (int i = -kHalf; i <= kHalf; ++i)
    for (int j = -kHalf; j <= kHalf; ++j)
      for (int k = -kHalf; k <= kHalf; ++k) {
        const double d = distance({i * kVoxel, j * kVoxel, k * kVoxel});
        if (d >= band) continue;
        if (d > -band)
          voxels.setValueOn({i, j, k}, float(d));
        else
          voxels.setValueOff({i, j, k}, float(-band));
      }
  return grid;
}

inline void write(const std::string& path, const openvdb::GridPtrVec& grids) { openvdb::io::File(path).write(grids); }

inline InputRequest request_for(const std::string& name) { return named_input(name); }

inline Input read(const InputRequest& request) { return read_input(request, int64_t(0)); }

inline std::string warnings_of(const InputRequest& request) {
  std::string told;
  read_input(request, int64_t(0), [&](MessageKind kind, const std::string& text) {
    if (kind == MessageKind::warning) told += text + '\n';
  });
  return told;
}

/// Of a few voxels, around one.
inline openvdb::FloatGrid::Ptr small_ball_at(const std::string& name, int x) {
  openvdb::initialize();
  auto grid = openvdb::FloatGrid::create(3.F);
  grid->setName(name);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  auto voxels = grid->getAccessor();
  for (int i = -6; i <= 6; ++i)
    for (int j = -6; j <= 6; ++j)
      for (int k = -6; k <= 6; ++k) voxels.setValue({x + i, j, k}, float(std::clamp(norm(i, j, k) - 4, -3., 3.)));
  return grid;
}

}  // namespace isoshell
