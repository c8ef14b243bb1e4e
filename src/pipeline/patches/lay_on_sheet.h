// Curves on a sheet, where they make it intersect itself no more than it does.
#pragma once

#include "features/cutting/lay_curves.h"
#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

/// lay_curves on the run's sheet, untangled. Vertices of triangles that intersect then stay where the sheet is: in
/// crevices that are narrower than a voxel a curve may come near the other wall. Cost: a look at all triangles, as
/// crossing_pairs, at least once. Throws: interrupted.
LaidCurves lay_on_sheet(const FeatureMesh& mesh, const CurveNetwork& network, const PreparedSurface& p,
                        Context& context);

}  // namespace isoshell
