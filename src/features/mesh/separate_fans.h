// Parts of a mesh that touch in a vertex only.
#pragma once

#include "features/mesh/feature_mesh.h"
#include "features/mesh/mesh_fans.h"

namespace isoshell {

/// Gives each fan of triangles around a vertex a vertex of its own: the first one keeps it, those of the others come
/// behind all vertices. Triangles keep their order, and corners theirs. Result: of each new vertex the one it was.
/// Throws: usage where an edge has more than two triangles, or two that pass it the same way.
std::vector<uint32_t> separate_fans(std::vector<WorldPoint>& position, MeshTriangles& triangles);

/// By how many vertices a mesh with separated fans has more on its curves than they have places. Cost: a sort of the
/// curves' edges, and a search for every triangle's.
int64_t count_separated_places(const FeatureMesh& mesh, const CurveNetwork& network, const MeshTriangles& separated);

}  // namespace isoshell
