// Paths of a fine mesh without some of their edges.
#pragma once

#include <vector>

#include "features/refine_mesh.h"

namespace isoshell {

using Paths = std::vector<CurvePath>;
using EdgesOfPaths = std::vector<std::vector<char>>;  ///< per path and edge

EdgesOfPaths no_edges_of(const Paths& paths);

/// How sharp each path is: the mean of 1 - cos of the angle by which the mesh turns there. Borders and other edges
/// without two triangles are the sharpest of all. Cost: a look at all triangles.
std::vector<double> turns_of(const FineMesh& mesh);

/// Without the edges that are flagged. What is left of a path ends in corners, and goes, too, where it is so short that
/// the result would have two edges there; so do other paths that are as short and end freely then, but borders and
/// non-manifold edges. Where paths have seeds, what goes lies between two of them.
Paths without_edges(const FineMesh& mesh, const EdgesOfPaths& goes);

/// Whether a path may be left out: its edges have two triangles.
bool may_go(const CurvePath& path);

}  // namespace isoshell
