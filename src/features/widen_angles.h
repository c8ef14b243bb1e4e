// The last word on triangles beside curves: where seeds of curves left angles that no place of the others mends.
#pragma once

#include <functional>

#include "features/patch_mesh.h"

namespace isoshell {

/// Puts the patches together. Then looks at the triangles with angles below 30 degrees, the worst first, each with
/// those around it: edges are split and collapsed there and vertices moved, also along the curves, where that makes the
/// worst angles wider and the triangles follow surface and curves no worse. As many edges are collapsed or split
/// elsewhere, where triangles stay good. Curves stay edges, and topology and count stay. Where the count cannot be met,
/// or `is_clean` says no of the mesh, it is as it was. In host memory. Cost: milliseconds a place.
JoinedPatches join_and_widen(const CutSurface& cut, const SeededMesh& made,
                             const std::function<bool(const DualMesh&)>& is_clean, Context& context);

}  // namespace isoshell
