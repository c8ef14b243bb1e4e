// make_surface_mesh: checks its arguments, then runs on the backend that the context asks for.
#include <string>

#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "surface", message); }

void require_extent(const SurfaceTriangles& from) {
  for (const int32_t extent : from.extent_vox)
    if (extent < 1 || extent > kMaxExtentVox)
      refuse("extent_vox is " + std::to_string(extent) + "; it must be 1 to " + std::to_string(kMaxExtentVox) +
             ": that of a LatticeFrame");
  for (size_t v = 0; v < from.position.size(); ++v) {
    const PointQ8 p = from.position[v];
    const int32_t at[3] = {p.x, p.y, p.z};
    for (int axis = 0; axis < 3; ++axis)
      if (at[axis] < 0 || at[axis] > from.extent_vox[axis] * kOneVoxelQ8)
        refuse("position[" + std::to_string(v) + "] is " + std::to_string(at[axis]) + "; it must be 0 to " +
               std::to_string(from.extent_vox[axis] * kOneVoxelQ8) + ", 256 times the extent: use a larger lattice");
  }
}

void require_countable(const SurfaceTriangles& from) {
  constexpr size_t kMost = kNone / 3;  // half-edges are numbered in 32 bits
  if (from.triangles.empty() || from.triangles.size() > kMost)
    refuse("there are " + std::to_string(from.triangles.size()) + " triangles; a surface has 1 to " +
           std::to_string(kMost));
  if (!from.patch.empty() && from.patch.size() != from.position.size())
    refuse("there are " + std::to_string(from.patch.size()) + " patches for " + std::to_string(from.position.size()) +
           " vertices; every vertex must have one, or none of them");
}

void require_corners(const SurfaceTriangles& from) {
  const size_t vertices = from.position.size();
  std::vector<char> used(vertices, 0);
  for (size_t t = 0; t < from.triangles.size(); ++t) {
    const TriangleIndices i = from.triangles[t];
    const auto name = [&] { return "triangles[" + std::to_string(t) + "]"; };
    for (const uint32_t v : {i.a, i.b, i.c}) {
      if (v >= vertices)
        refuse(name() + " has vertex " + std::to_string(v) + "; there are " + std::to_string(vertices));
      used[v] = 1;
    }
    if (i.a == i.b || i.b == i.c || i.c == i.a)
      refuse(name() + " has a vertex twice; leave out triangles of fewer than three vertices");
    if (!from.patch.empty() && (from.patch[i.a] != from.patch[i.b] || from.patch[i.b] != from.patch[i.c]))
      refuse(name() + " has vertices of two patches; give every patch vertices of its own");
  }
  for (size_t v = 0; v < vertices; ++v)
    if (!used[v]) refuse("position[" + std::to_string(v) + "] is in no triangle; leave such vertices out");
}

}  // namespace

MadeSurface make_surface_mesh(const SurfaceTriangles& from, Context& context) {
  require_countable(from);
  require_extent(from);
  require_corners(from);
  return backend_for(context).make_surface_mesh(from, context);
}

}  // namespace isoshell
