// The result: triangles in world units.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/attribute.h"
#include "isoshell/lattice.h"

namespace isoshell {

/// Result: vertices in seed id order; each triangle starts at its smallest index, triangles are sorted; orientation
/// outward (counter-clockwise seen from outside).
struct TriangleMesh {
  std::vector<WorldPoint> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint8_t> gap = {};  ///< per vertex 1 where the input has no surface; empty when it has everywhere
  std::vector<Attribute> attributes = {};  ///< of the input, where they were transferred
  AttributeFiles files = {};               ///< that attributes speak of
};

}  // namespace isoshell
