// Unit normals of triangles, as given and smoothed for the detection of creases.
#pragma once

#include "features/mesh/mesh_edges.h"
#include "geometry/world_vector.h"

namespace isoshell {

/// Unit normal of every triangle. One so thin that rounding decides its normal has that of a neighbour, or none: 0.
Buffer<WorldPoint> face_normals(const FeatureMesh& mesh, const MeshEdges& edges);

/// The normals after a bilateral filter over neighbours within about `reach_world`: noise goes, creases stay. A few
/// more without meaning lie behind those of the triangles.
Buffer<WorldPoint> filter_normals(const FeatureMesh& mesh, const MeshEdges& edges, View<const WorldPoint> normals,
                                  double reach_world);

inline bool has_normal(const WorldPoint& n) { return n.x != 0 || n.y != 0 || n.z != 0; }

/// 1 - the cosine of the angle between two normals; 0 where one is unknown.
inline double turn_between(const WorldPoint& a, const WorldPoint& b) {
  return has_normal(a) && has_normal(b) ? 1 - dot(a, b) : 0;
}

/// 1 - the cosine of an angle of 0 to 180 degrees, by the same operations everywhere.
double turn_of_degrees(double degrees);

}  // namespace isoshell
