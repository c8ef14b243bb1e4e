// Lattice positions become world positions, once.
#include "core/copy_product.h"

namespace isoshell {

TriangleMesh to_world(const DualMesh& dual, const LatticeFrame& frame) {
  const OnHost<DualMesh> mesh(dual);
  TriangleMesh out;
  out.vertices.reserve(size_t(mesh->position.size()));
  for (PointQ8 p : mesh->position) out.vertices.push_back(frame.to_world(p));
  out.triangles.reserve(size_t(mesh->triangles.size()));
  for (TriangleIndices t : mesh->triangles) out.triangles.push_back({t.a, t.b, t.c});
  return out;
}

}  // namespace isoshell
