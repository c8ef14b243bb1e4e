// The result: triangles in world units.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/advanced/lattice.h"
#include "isoshell/attribute.h"
#include "isoshell/regions.h"

namespace isoshell {

/// An edge of a mesh on a curve.
struct MeshCurveEdge {
  std::array<uint32_t, 2> vertex;  ///< the smaller first
  uint32_t curve;                  ///< the same number for all edges of a curve
};

/// The patches and curves of the input that a mesh has; empty where none were kept.
struct MeshFeatures {
  std::vector<uint32_t> patch = {};             ///< per triangle
  std::vector<MeshCurveEdge> curve_edges = {};  ///< sorted
  std::vector<uint32_t> corners = {};           ///< vertices where curves end or turn sharply, ascending
};

/// Result: vertices in seed id order; each triangle starts at its smallest index, triangles are sorted; orientation
/// outward (counter-clockwise seen from outside).
struct TriangleMesh {
  std::vector<WorldPoint> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint8_t> gap = {};  ///< per vertex 1 where the input has no surface; empty when it has everywhere
  std::vector<Attribute> attributes = {};  ///< of the input, where they were transferred
  AttributeFiles files = {};               ///< that attributes speak of
  MeshFeatures features = {};              ///< of the input, where they were kept
  FaceRegions regions = {};                ///< of the input, where it has any
};

}  // namespace isoshell
