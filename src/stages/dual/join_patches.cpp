// join_patches (see stages.h), on the host: a look at every vertex and triangle, and a sort.
#include <algorithm>

#include "core/copy_product.h"
#include "stages/halfedge/labelled_triangles.h"

namespace isoshell {

JoinedMesh join_patches(const DualMesh& mesh, const FixedSeeds& fixed) {
  const OnHost<DualMesh> open(mesh);
  const Buffer<uint32_t> joined = fixed.joined.to_host();
  JoinedMesh out;
  out.vertex_of = Buffer<uint32_t>(open->position.size());
  uint32_t places = 0;
  for (int64_t v = 0; v < open->position.size(); ++v) {
    const bool is_copy = v < joined.size() && joined[v] != uint32_t(v);
    out.vertex_of[v] = is_copy ? out.vertex_of[joined[v]] : places++;
  }
  out.mesh.position = Buffer<PointQ8>(places);
  for (int64_t v = open->position.size() - 1; v >= 0; --v) out.mesh.position[out.vertex_of[v]] = open->position[v];
  out.mesh.triangles = Buffer<TriangleIndices>(open->triangles.size());
  for (int64_t t = 0; t < open->triangles.size(); ++t) {
    const TriangleIndices i = open->triangles[t];
    out.mesh.triangles[t] = smallest_first({out.vertex_of[i.a], out.vertex_of[i.b], out.vertex_of[i.c]});
  }
  std::sort(out.mesh.triangles.begin(), out.mesh.triangles.end(), ByIndices{});
  return out;
}

}  // namespace isoshell
