// The primitives of all instances of meshes, and their triangles.
#pragma once

#include "io/faces/face_collector.h"
#include "io/gltf/gltf_scene.h"

namespace isoshell {

/// Vertices that primitives of one instance share: those of one set of accessors.
struct GltfVertices {
  const GltfDocument::Json* attributes;
  std::string place;
  const GltfTransform* to_world;
  int64_t first, count;
  GltfAccessor position;

  /// The accessor of an attribute, checked to have as many elements as there are positions; none without one.
  std::optional<GltfAccessor> find(const GltfDocument& document, const std::string& semantic) const;
};

struct GltfPrimitive {
  size_t vertices;
  int64_t mode;
  std::optional<int64_t> indices, material;
  std::string place;
};

struct GltfContent {
  std::vector<GltfInstance> instances;
  std::vector<int64_t> first_vertex, first_set;  ///< per instance, and one more: into all vertices, and `vertices`
  std::vector<GltfVertices> vertices;
  std::vector<GltfPrimitive> primitives;  ///< of triangles
  int64_t claimed_corners = 0;            ///< of all primitives, as the file says, unchecked
  int64_t other_primitives = 0;           ///< of points and lines, or without positions
  int64_t posed_meshes = 0;               ///< with skins or morph targets

  View<const GltfVertices> vertices_of(size_t instance) const {
    return {vertices.data() + first_set[instance], first_set[instance + 1] - first_set[instance]};
  }
};

/// Reads no element of any accessor.
GltfContent content_of(const GltfDocument& document);

/// Of all primitives, in order; `material` per triangle, -1 for none. Corners are numbers of vertices of the content.
struct GltfTriangles {
  int64_t count = 0;
  std::vector<Triangle> corners;  ///< empty where corner k of triangle t is vertex 3 t + k, of all vertices
  std::vector<double> material;   ///< empty where no primitive has one

  Triangle at(size_t t) const {
    const auto first = uint32_t(3 * t);
    return corners.empty() ? Triangle{first, first + 1, first + 2} : corners[t];
  }
  /// So that `corners` is not empty.
  void write_out(const MeshSource& source);
};
GltfTriangles triangles_of(const GltfDocument& document, const GltfContent& content);

}  // namespace isoshell
