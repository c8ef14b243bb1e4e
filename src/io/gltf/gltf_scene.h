// Which meshes stand where.
#pragma once

#include "io/gltf/gltf_document.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// Of points; rows of three and a translation.
struct GltfTransform {
  double m[3][4] = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}};
  bool is_identity = true;

  WorldPoint point(const WorldPoint& p) const;
  /// Of length as it comes; outward directions stay outward in mirrored nodes, too.
  WorldPoint normal(const WorldPoint& n) const;
  bool mirrors() const;
};

struct GltfInstance {
  int64_t mesh;
  GltfTransform to_world;
  bool has_skin;
};

/// Meshes of the nodes of the file's scene, each node before its children; all meshes where there are no nodes.
std::vector<GltfInstance> instances_of(const GltfDocument& document);

}  // namespace isoshell
