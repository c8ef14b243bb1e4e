// Internal faces: walls between the parts of a solid.
#pragma once

#include <optional>

#include "features/mesh/feature_mesh.h"

namespace isoshell {

struct WithoutInternalFaces {
  FeatureMesh mesh;                                   ///< the solid's surface, which looks outward
  int64_t dropped = 0;                                ///< triangles that were dropped
  std::vector<std::array<WorldPoint, 2>> interfaces;  ///< edges of the surface where walls met it
};

/// Drops the triangles that have solid on both sides: interfaces between parts, which share edges with three faces or
/// more. Around such an edge space is cut into regions, sorted by angle; the one around everything is air, and so is
/// one that only front sides look into; the others are solid. Parts that share no edge are left as they are. None where
/// no wall is, an edge has one triangle, or a triangle has air on both sides. Cost: a sort of the half-edges.
std::optional<WithoutInternalFaces> drop_internal_faces(const FeatureMesh& mesh);

}  // namespace isoshell
