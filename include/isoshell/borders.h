// The borders of a mesh, and how far they are from those of another one.
#pragma once

#include "isoshell/backend.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Edges of one triangle, in world units. Distances are 0 where one of the meshes has no border.
struct BorderMeasures {
  int64_t loops = 0;  ///< those that touch in a vertex between two fans of triangles are two
  double length_world = 0;
  int64_t reference_loops = 0;
  double reference_length_world = 0;
  double to_reference_max = 0;    ///< of border vertices to the nearest point of the reference's border
  double from_reference_max = 0;  ///< of the reference's border vertices
};

/// By indices alone: vertices of one position are as many as they are. Cost: sorts of the edges, and a search in a grid
/// for each border vertex. Throws: usage when a triangle names a vertex that there is not.
BorderMeasures measure_borders(const TriangleMesh& mesh, const TriangleMesh& reference, Context& context);

}  // namespace isoshell
