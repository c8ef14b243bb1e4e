// Straight walks over the triangles beside an edge.
#pragma once

#include <vector>

#include "features/mesh/mesh_edges.h"

namespace isoshell {

struct WalkGround {
  const FeatureMesh& mesh;
  const MeshEdges& edges;
  View<const WorldPoint> normals;      ///< per triangle
  const std::vector<uint8_t>& is_end;  ///< per edge: walks end there
};

struct BesideEdge {
  double turn;          ///< the largest, 1 - cosine, away from the normal of the face that the walk begins on
  double walked_world;  ///< to the end, or to the first edge behind it
  int crossed;          ///< edges
};

/// Along the straight geodesic that leaves the middle of an edge at a right angle over `face`, and is so long, or ends
/// at an edge that ends walks.
BesideEdge look_beside(const WalkGround& ground, uint32_t edge, uint32_t face, double length_world);

}  // namespace isoshell
