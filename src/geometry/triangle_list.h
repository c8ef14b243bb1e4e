// Lists of triangles, and what functions of the library ask of those that callers give them.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/error.h"

namespace isoshell {

inline bool is_finite(const WorldPoint& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

inline bool repeats_corner(const std::array<uint32_t, 3>& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

inline std::vector<std::array<uint32_t, 3>> list_of(View<const TriangleIndices> triangles) {
  std::vector<std::array<uint32_t, 3>> list;
  list.reserve(size_t(triangles.size));
  for (const TriangleIndices& t : triangles) list.push_back({t.a, t.b, t.c});
  return list;
}

/// Throws: usage where a triangle has a corner that is no vertex.
inline void require_indices(const std::vector<std::array<uint32_t, 3>>& triangles, size_t vertices, const char* stage) {
  for (const auto& t : triangles)
    if (const uint32_t largest = std::max({t[0], t[1], t[2]}); largest >= vertices)
      throw Error(ErrorCode::usage, stage,
                  "a triangle names vertex " + std::to_string(largest) + "; there are " + std::to_string(vertices));
}

}  // namespace isoshell
