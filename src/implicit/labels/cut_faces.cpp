// triangles_of_faces (see cut_faces.h).
#include "implicit/labels/cut_faces.h"

namespace isoshell {

std::vector<TriangleIndices> triangles_of_faces(const std::vector<std::array<uint32_t, 4>>& faces,
                                                const std::vector<PointQ8>& position) {
  std::vector<TriangleIndices> triangles;
  triangles.reserve(2 * faces.size());
  for (const auto& face : faces)
    each_triangle(face, position, [&](const TriangleIndices& t) { triangles.push_back(t); });
  return triangles;
}

}  // namespace isoshell
