// The last word on triangles beside curves: where seeds of curves left angles that no place of the others repairs.
#pragma once

#include <functional>

#include "features/angles/patch_mesh.h"

namespace isoshell {

/// Corners of triangles of a mesh that intersect as those of the input do not; empty: the mesh is clean.
using Crossings = std::function<std::vector<PointQ8>(const DualMesh&)>;

/// Puts the patches together. Then looks at the triangles with angles below 30 degrees, the worst first, each with
/// those around it: edges are split and collapsed there and vertices moved, also along the curves, where that makes the
/// worst angles wider and the triangles follow surface and curves no worse. As many edges are collapsed or split
/// elsewhere, where triangles stay good, until there are as many vertices as asked for, or as near to that as it goes.
/// Curves stay edges, and the topology stays. Where triangles of the result intersect, it is made again without changes
/// around them; where that does not end intersections, the mesh is as it was. In host memory. Cost: about a millisecond
/// a poor triangle.
JoinedPatches join_and_widen(const CutSurface& cut, const SeededMesh& made, const JoinOptions& options,
                             const Crossings& crossings, Context& context);

}  // namespace isoshell
