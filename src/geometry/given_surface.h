// Surfaces from memory, which may be anything, where readers make only what TriangleSoup promises.
#pragma once

#include <string>

#include "isoshell/surface_source.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Throws: unreadable_input for a triangle whose vertex is not there or not finite, and for attributes or regions that
/// do not fit; `name` is what the message calls the surface.
void check_surface(const TriangleSoup& soup, const std::string& name);

/// The same triangles, with the attributes and regions of a mesh. Throws: as check_surface does.
TriangleSoup surface_of(const TriangleMesh& mesh);

}  // namespace isoshell
