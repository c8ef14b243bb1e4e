// The last word on triangles beside curves: where seeds of curves left angles that no place of the others repairs.
#pragma once

#include "features/angles/patch_mesh.h"

namespace isoshell {

/// Looks at the triangles with angles below 30 degrees, the worst first, each with those around it: edges are split and
/// collapsed there and vertices moved, also along the curves, where that makes the worst angles wider and the triangles
/// follow surface and curves no worse. As many edges are collapsed or split elsewhere, where triangles stay good, until
/// there are as many vertices as asked for, or as near to that as it goes. Curves stay edges, the topology stays, and
/// no triangles come to intersect. The same for every number of threads. In host memory. Cost: about a
/// millisecond a poor triangle, for no more of them than options allow; some more for the last sixteen.
void widen(PatchMesh& mesh, const Context& context);

}  // namespace isoshell
