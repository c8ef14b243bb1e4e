// What one surface has beside its positions, found for another.
#pragma once

#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// The attributes of `source` on the mesh.
///
/// Of vertices: interpolated in the triangle of the source's nearest point. A triangle that looks away from the
/// vertex's normal counts only where none that looks its way is within half the length of the vertex's edges beyond the
/// nearest, so two sides of a thin wall stay apart. Of triangles that are equally near the one of the smallest index
/// counts. Of faces: the value of the face under a face's middle, found likewise. Of corners: interpolated at the
/// nearest point of those faces that go on from the one under the middle without a jump of that attribute, so both
/// sides of a crease or a seam keep their own. One that jumps nowhere is found by vertices. Corners of a vertex share a
/// value where it is the same. Normals get length 1.
///
/// Integers are rounded to the nearest and limited to the range of their type, numbers of type f32 rounded to single
/// precision; what is not a number at a corner is not one in the whole triangle. Host only. Result: does not depend on
/// threads or backend. Throws: usage when counts or indices do not fit, a position is not finite or there is
/// no triangle; interrupted.
std::vector<Attribute> transfer_attributes(const TriangleSoup& source, const std::vector<Attribute>& attributes,
                                           const TriangleMesh& mesh, Context& context);

}  // namespace isoshell
