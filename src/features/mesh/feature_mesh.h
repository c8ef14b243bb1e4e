// The input as its features see it: a welded mesh in world units, and the curves on its edges.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// A triangle mesh whose vertices of one position are one vertex; no triangle has two corners at one place, and none is
/// there twice.
struct FeatureMesh {
  std::vector<WorldPoint> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  std::vector<uint32_t> source_face;  ///< per triangle its face in the soup
  double rounding_world = 0;          ///< by how far coordinates may be off
};

/// Edges by their ends.
using EdgeList = std::vector<std::array<uint32_t, 2>>;

enum class CurveKind : uint8_t {
  border,        ///< edges of one triangle
  non_manifold,  ///< edges of three triangles or more, or of two that pass them the same way
  crease,        ///< edges between triangles at an angle
  seam,          ///< edges where an attribute of corners or faces jumps
  line,          ///< edges on a line that was given
};

/// A path along edges of the mesh whose inner vertices are on no other curve. Both ends of one that is no loop are
/// corners.
struct FeatureCurve {
  CurveKind kind = CurveKind::crease;
  bool is_loop = false;          ///< an edge joins the last vertex to the first, which is not repeated
  std::vector<uint32_t> vertex;  ///< two or more; a loop has three or more, and begins with its smallest
};

/// Every border and non-manifold edge, and the creases that were found. In order of the smallest edge of each curve.
struct CurveNetwork {
  std::vector<FeatureCurve> curves;
  std::vector<uint32_t> corners;  ///< ascending: where curves end
};

}  // namespace isoshell
