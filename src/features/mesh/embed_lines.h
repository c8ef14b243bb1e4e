// Lines on a mesh become paths along its edges.
#pragma once

#include <cstddef>

#include "features/mesh/feature_mesh.h"

namespace isoshell {

/// A point in a triangle, or on its border.
struct PointOnMesh {
  uint32_t triangle;
  WorldPoint at;
};

struct LinesOnMesh {
  std::vector<PointOnMesh> points;
  std::vector<std::array<uint32_t, 2>> segments;  ///< two points each
};

struct MeshWithLines {
  FeatureMesh mesh;                   ///< the same surface, cut into more triangles
  EdgeList edges;                     ///< that the segments run along, ascending, the smaller end first
  std::vector<EdgeList> ways;         ///< the same, per segment; empty where its points fall together, or it is lost
  std::vector<uint32_t> vertex;       ///< per point
  std::vector<EdgeList> followed;     ///< the parts of the edges that were to be followed
  std::vector<size_t> lost_segments;  ///< ascending: those for which the surface leads no way
};

/// Makes a vertex of every point, and cuts the triangles between the ends of a segment where the plane through both
/// meets them that stands on the surface there. What comes within the tolerance of a vertex goes through it, what ends
/// within the tolerance of an edge ends on it: so no triangle gets narrower than that. Segments are taken in their
/// order. Vertices, and triangles that are not cut, keep their numbers. A segment is lost where the surface ends, leads
/// another way, or makes it more than three times as long. Cost: O(mesh), and O(triangles cut) times what meets in a
/// vertex.
MeshWithLines embed_lines(FeatureMesh mesh, const LinesOnMesh& lines, const std::vector<EdgeList>& followed,
                          double tolerance_world);

}  // namespace isoshell
