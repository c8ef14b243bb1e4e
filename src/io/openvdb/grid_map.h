// Where the voxels of OpenVDB's grids stand.
#pragma once

#include <openvdb/openvdb.h>

#include <array>
#include <memory>
#include <sstream>
#include <string>

#include "io/vdb/volume_readers.h"
#include "isoshell/error.h"

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

/// A transform of voxels of any size, as a file has it: the constructors of OpenVDB refuse scales whose product is
/// below 3e-15, and what reads files does not. Without a translation it equals one that OpenVDB's programs make so.
inline openvdb::math::Transform::Ptr transform_of_scales(const openvdb::Vec3d& scale,
                                                         const openvdb::Vec3d& translation) {
  using namespace openvdb::math;
  const bool is_uniform = scale.x() > 0 && scale.x() == scale.y() && scale.x() == scale.z();
  const bool has_translation = translation != openvdb::Vec3d(0);
  const openvdb::Vec3d inverse = 1.0 / scale, size(Abs(scale.x()), Abs(scale.y()), Abs(scale.z()));
  std::stringstream bytes;
  openvdb::io::setCurrentVersion(bytes);
  if (has_translation) {
    openvdb::writeString(bytes, is_uniform ? UniformScaleTranslateMap::mapType() : ScaleTranslateMap::mapType());
    translation.write(bytes);
  } else {
    openvdb::writeString(bytes, is_uniform ? UniformScaleMap::mapType() : ScaleMap::mapType());
  }
  for (const openvdb::Vec3d& part : {scale, size, inverse, inverse * inverse, inverse / 2}) part.write(bytes);
  auto transform = std::make_shared<Transform>();
  transform->read(bytes);
  return transform;
}

/// Of voxels by the steps from one to the next. As scales and a translation where these are along the axes: files hold
/// these of voxels of any size. Throws: openvdb::Exception for other steps that span so little that they have no
/// inverse.
inline openvdb::math::Transform::Ptr transform_of(const std::array<WorldPoint, 3>& step, const WorldPoint& origin) {
  using openvdb::math::Transform;
  const auto& [x, y, z] = step;
  if (x.y == 0 && x.z == 0 && y.x == 0 && y.z == 0 && z.x == 0 && z.y == 0)
    return transform_of_scales({x.x, y.y, z.z}, {origin.x, origin.y, origin.z});
  openvdb::math::Mat4d rows = openvdb::math::Mat4d::identity();  // of where the axes go, then the origin
  rows.setRow(0, {x.x, x.y, x.z, 0});
  rows.setRow(1, {y.x, y.y, y.z, 0});
  rows.setRow(2, {z.x, z.y, z.z, 0});
  rows.setRow(3, {origin.x, origin.y, origin.z, 1});
  return std::make_shared<Transform>(std::make_shared<openvdb::math::AffineMap>(rows));
}

/// The same for steps that a program gives. Throws: usage for steps that span no volume; `name` is what the message
/// calls the volume.
inline openvdb::math::Transform::Ptr transform_of(const std::array<WorldPoint, 3>& step, const WorldPoint& origin,
                                                  const std::string& name) {
  try {
    if (is_invertible(lattice_map(step, origin))) return transform_of(step, origin);
  } catch (const openvdb::Exception&) {
  }
  throw Error(ErrorCode::usage, "arguments",
              name +
                  ": its steps from value to value span no volume, or so little that they have no inverse; give "
                  "three finite ones that do");
}

}  // namespace isoshell
