// What functions of the library ask of the meshes that callers give them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "isoshell/advanced/lattice.h"
#include "isoshell/error.h"

namespace isoshell {

inline bool is_finite(const WorldPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

/// Throws: usage where a triangle has a corner that is no vertex.
inline void require_indices(const std::vector<std::array<uint32_t, 3>>& triangles, size_t vertices, const char* stage) {
  for (const auto& t : triangles)
    if (const uint32_t largest = std::max({t[0], t[1], t[2]}); largest >= vertices)
      throw Error(ErrorCode::usage, stage,
                  "a triangle names vertex " + std::to_string(largest) + "; there are " + std::to_string(vertices));
}

}  // namespace isoshell
