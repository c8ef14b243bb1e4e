// Triangles thinner than rounding can tell, and strips far narrower than edges, out of a mesh that is to be cut.
#pragma once

#include <cstdint>
#include <vector>

#include "features/mesh/feature_mesh.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/backend.h"

namespace isoshell {

/// A triangle that is less high has a normal that rounding decides, and parts that fold when they are rounded.
double least_height_world(const FeatureMesh& mesh);

/// Flips edges of thinner triangles in planes until they are Delaunay, flips the longest edge of one beside a triangle
/// that is high enough, whose third corner is on that edge but for the least height, and collapses edges shorter than
/// that. Strips between creases that are narrower than a 32nd of the edge length become one crease: in results of such
/// edges they would be triangles with angles of two degrees or less. Vertices do not move, and none is taken into one
/// farther away than these heights; their order stays. `kept`: keys of edges that stay with their ends, ascending.
/// `edge_length_world`: 0 where strips are to stay. A triangle stays where a change would fold the surface, join sides
/// of it or make triangles meet on the lattice that did not, or where more than a thousand triangles meet. Result:
/// whether anything changed. Cost: a pass over the triangles where none is thin, else a sort of the half-edges, all
/// triangles put into an EditableMesh whose triangles are kept apart, and a look at those around each change. Throws:
/// interrupted.
bool remove_slivers(FeatureMesh& mesh, const LatticeFrame& frame, const std::vector<uint64_t>& kept,
                    double edge_length_world, const Context& context);

}  // namespace isoshell
