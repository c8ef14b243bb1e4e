// The lines that a user gives, on the surface of a run.
#pragma once

#include "features/mesh/embed_lines.h"
#include "isoshell/remesh_options.h"
#include "pipeline/grid/run_log.h"

namespace isoshell {

/// Snaps the points of the lines to the nearest ones of the mesh, and embeds the lines. `followed` are edges of the
/// mesh that may be split for it. A segment with an end that is farther from the mesh than half the edge length is left
/// out, as is one for which the surface leads no way: a warning names the first, and `lost` has all of them. Throws:
/// usage where that leaves none.
MeshWithLines with_given_lines(FeatureMesh mesh, const Polylines& lines, const std::vector<EdgeList>& followed,
                               double edge_length_world, double voxel_size, std::vector<LostCurve>& lost, Run& run);

}  // namespace isoshell
