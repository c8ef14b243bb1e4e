// The primitives of all instances of meshes, and their triangles.
#pragma once

#include "io/mesh/face_collector.h"
#include "io/mesh/gltf_scene.h"

namespace isoshell {

/// Vertices that primitives of one instance share: those of one set of accessors.
struct GltfVertices {
  const GltfDocument::Json* attributes;
  std::string place;
  const GltfTransform* to_world;
  int64_t first, count;

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
  std::vector<int64_t> first_vertex;  ///< per instance, and one more
  std::vector<GltfVertices> vertices;
  std::vector<GltfPrimitive> primitives;  ///< of triangles
  int64_t other_primitives = 0;           ///< of points and lines, or without positions
  int64_t posed_meshes = 0;               ///< with skins or morph targets
};

/// Reads no element of any accessor.
GltfContent content_of(const GltfDocument& document);

/// Of all primitives, in order; `material` per triangle, -1 for none. Corners are numbers of vertices of the content.
struct GltfTriangles {
  std::vector<Triangle> corners;
  std::vector<double> material;  ///< empty where no primitive has one
};
GltfTriangles triangles_of(const GltfDocument& document, const GltfContent& content);

}  // namespace isoshell
