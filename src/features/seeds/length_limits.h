// How long edges of the result may be beside curves and where the surface bends. All lengths are in 1/256 voxel; `e` is
// the edge length at which the fine mesh was cut. What limits nothing leaves a vertex's limit as it is.
#pragma once

#include <vector>

#include "features/mesh/vertex_graph.h"

namespace isoshell {

/// Longest edge over the radius of a curve or surface.
constexpr double kEdgeOfRadius = 0.35;

/// On paths: by how far they turn within e, all turns of one direction; those of jagged ones are no bends.
void limit_by_curve_turns(const std::vector<WorldPoint>& position, const std::vector<CurvePath>& paths, double e,
                          std::vector<double>& limit);
/// Per vertex how far normals, averaged within about e / 2, turn within e where they turn most; 0 on paths. Sums of
/// integers: no order shows.
std::vector<double> surface_turns(const FineMesh& mesh, const VertexGraph& graph, double e);
/// Off paths: by these turns.
void limit_by_surface_turns(const FineMesh& mesh, const VertexGraph& graph, double e, std::vector<double>& limit);

}  // namespace isoshell
