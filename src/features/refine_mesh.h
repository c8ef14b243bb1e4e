// A mesh with short edges, and with vertices where its curves get seeds.
#pragma once

#include "features/curve_paths.h"
#include "isoshell/backend.h"

namespace isoshell {

struct RefineOptions {
  double longest = 0;      ///< an edge of the mesh is cut into equal parts of at most this, in 1/256 voxel
  double edge_length = 0;  ///< aimed at; paths are cut into segments of about this length
};
/// Triangles and paths on lattice positions that are not rounded yet, in 1/256 voxel.
struct FineMesh {
  std::vector<WorldPoint> position;
  MeshTriangles triangles;
  std::vector<CurvePath> paths;
};

/// Cuts every edge into equal parts, that of a path where seeds belong first, and fills each triangle between the parts
/// of its edges. Result: edges are at most 1.5 times `longest`. What becomes of a triangle depends on its corners only.
/// Cost: a sort of the edges, then O(fine triangles); of a long thin triangle these are as many as its edges have
/// parts. Throws: usage when that is far more than the area needs.
FineMesh refine_mesh(FineMesh mesh, const RefineOptions& options, Context& context);

}  // namespace isoshell
