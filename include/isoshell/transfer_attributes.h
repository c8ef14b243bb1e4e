// What stands at the vertices of one surface, found for the vertices of another.
#pragma once

#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// The attributes, one value for each vertex of `source`, at the vertices of the mesh: interpolated in the triangle of
/// the source's nearest point. A triangle that looks away from the vertex's normal counts only where none that looks
/// its way is within half the length of the vertex's edges beyond the nearest, so two sides of a thin wall stay apart.
/// Of triangles that are equally near, as on both sides of a crease, the one of the smallest index counts. Integers are
/// rounded to the nearest and limited to the range of their type, numbers of type f32 rounded to single precision; what
/// is not a number at a corner is not one in the whole triangle. Host only. Result: does not depend on threads or
/// backend. Throws: usage when counts do not fit or there is no triangle; interrupted.
std::vector<VertexAttribute> transfer_attributes(const TriangleSoup& source,
                                                 const std::vector<VertexAttribute>& attributes,
                                                 const TriangleMesh& mesh, Context& context);

}  // namespace isoshell
