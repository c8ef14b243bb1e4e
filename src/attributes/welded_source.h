// A surface with attributes as one welded mesh, and where its attributes jump.
#pragma once

#include <vector>

#include "features/mesh/mesh_edges.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// The soup's faces, welded by position, with the edges between them.
struct WeldedSource {
  FeatureMesh mesh;
  MeshEdges edges;
  std::vector<uint8_t> first_corner;  ///< per triangle the corner of its face that it starts with

  /// Of the soup, that a triangle's corner is.
  uint32_t corner(uint32_t triangle, uint32_t i) const {
    return 3 * mesh.source_face[triangle] + (first_corner[triangle] + i) % 3;
  }
};
WeldedSource weld_source(const TriangleSoup& soup);

/// Where on an inner edge the values of its two faces differ.
enum class Jump : uint8_t { none, at_one_end, at_both_ends };

/// Per edge, of an attribute of corners or faces; none at edges that are no inner ones. Corners whose values differ by
/// no more than rounding, as of programs that compute each by itself, do not jump.
std::vector<Jump> find_jumps(const WeldedSource& source, const Attribute& attribute);

}  // namespace isoshell
