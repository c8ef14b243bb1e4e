// Paths of a fine mesh without some of their edges.
#pragma once

#include <vector>

#include "features/mesh/refine_mesh.h"

namespace isoshell {

using Paths = std::vector<CurvePath>;
using EdgesOfPaths = std::vector<std::vector<char>>;  ///< per path and edge

EdgesOfPaths no_edges_of(const Paths& paths);

/// How sharp each path is: the mean of 1 - cos of the angle by which the mesh turns there, 0 where edges have not two
/// triangles. Cost: a look at all triangles.
std::vector<double> turns_of(const FineMesh& mesh);

/// Without the edges that are flagged, which are all those between some seeds. What is left of a path ends in corners,
/// and goes, too, where it has less than three segments; so do other creases that are as short and end freely then.
Paths without_edges(const FineMesh& mesh, const EdgesOfPaths& goes);

}  // namespace isoshell
