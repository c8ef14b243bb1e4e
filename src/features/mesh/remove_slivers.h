// Triangles thinner than rounding can tell, out of a mesh that is to be cut.
#pragma once

#include <cstdint>
#include <vector>

#include "features/mesh/feature_mesh.h"
#include "isoshell/backend.h"

namespace isoshell {

/// A triangle that is less high has a normal that rounding decides, and parts that fold when they are rounded.
double least_height_world(const FeatureMesh& mesh);

/// Flips edges of thinner triangles in planes until they are Delaunay, flips the longest edge of one beside a triangle
/// that is high enough, whose third corner is on that edge but for the least height, and collapses edges shorter than
/// that. Vertices do not move, and none is taken into one farther away than the least height; their order stays.
/// `kept`: keys of edges that stay with their ends, ascending. A triangle stays where a change would fold the surface
/// or join sides of it, or more than a thousand triangles meet. Result: whether anything changed. Cost: a pass over the
/// triangles where none is thin, else a sort of the half-edges, and a look at the triangles around each change. Throws:
/// interrupted.
bool remove_slivers(FeatureMesh& mesh, const std::vector<uint64_t>& kept, const Context& context);

}  // namespace isoshell
