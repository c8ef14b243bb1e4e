// Where the values of a dense volume stand, as OpenVDB has it.
#pragma once

#include <openvdb/math/Transform.h>

#include <cmath>
#include <string>

#include "isoshell/error.h"
#include "isoshell/io/memory_input.h"

namespace isoshell {

/// Throws: usage for a spacing that is not above 0; `name` is what the message calls the volume.
inline openvdb::math::Transform::Ptr transform_of(const DenseVolume& volume, const std::string& name) {
  const WorldPoint &spacing = volume.spacing_world, &origin = volume.origin_world;
  for (const double s : {spacing.x, spacing.y, spacing.z})
    if (!(s > 0) || !std::isfinite(s))
      throw Error(ErrorCode::usage, "arguments", name + ": its spacing must be above 0 along every axis");
  auto transform = openvdb::math::Transform::createLinearTransform(1);
  transform->postScale({spacing.x, spacing.y, spacing.z});
  transform->postTranslate({origin.x, origin.y, origin.z});
  return transform;
}

}  // namespace isoshell
