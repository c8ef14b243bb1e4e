#include "io/gltf/gltf_vertices.h"

#include <algorithm>

#include "core/attribute_values.h"

namespace isoshell {
namespace {

bool have_same_values(const std::vector<const Attribute*>& attributes, size_t a, size_t b) {
  return std::all_of(attributes.begin(), attributes.end(), [&](const Attribute* attribute) {
    return is_same(value_of(*attribute, a), value_of(*attribute, b), attribute->components);
  });
}

/// The corners of each vertex, ascending: those of vertex v are [first[v], first[v + 1]).
struct CornersOfVertices {
  std::vector<size_t> first, corner;

  explicit CornersOfVertices(const TriangleMesh& mesh)
      : first(mesh.vertices.size() + 1, 0), corner(3 * mesh.triangles.size()) {
    for (const auto& t : mesh.triangles)
      for (const uint32_t v : t) ++first[v + 1];
    for (size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
    std::vector<size_t> next(first.begin(), first.end() - 1);
    for (size_t c = 0; c < corner.size(); ++c) corner[next[mesh.triangles[c / 3][c % 3]]++] = c;
  }
};

}  // namespace

GltfVertexSplit split_vertices(const TriangleMesh& mesh, const std::vector<const Attribute*>& of_corners) {
  GltfVertexSplit split;
  split.triangles.resize(mesh.triangles.size());
  const CornersOfVertices corners(mesh);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const size_t first = split.vertex.size();
    for (size_t i = corners.first[v]; i < corners.first[v + 1]; ++i) {
      const size_t c = corners.corner[i];
      size_t at = first;
      while (at < split.vertex.size() && !have_same_values(of_corners, split.corner[at], c)) ++at;
      if (at == split.vertex.size()) {
        split.vertex.push_back(uint32_t(v));
        split.corner.push_back(c);
      }
      split.triangles[c / 3][c % 3] = uint32_t(at);
    }
    if (corners.first[v] != corners.first[v + 1]) continue;
    split.vertex.push_back(uint32_t(v));  // without a triangle, and so without values of corners
    split.corner.push_back(SIZE_MAX);
  }
  return split;
}

}  // namespace isoshell
