// The result: triangles in world units.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/lattice.h"
#include "isoshell/vertex_attribute.h"

namespace isoshell {

/// Result: vertices in seed id order; each triangle starts at its smallest index, triangles are sorted; orientation
/// outward (counter-clockwise seen from outside).
struct TriangleMesh {
  std::vector<WorldPoint> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint8_t> gap = {};  ///< per vertex 1 where the input has no surface; empty when it has everywhere
  std::vector<VertexAttribute> attributes = {};  ///< of the input, where they were transferred
};

}  // namespace isoshell
