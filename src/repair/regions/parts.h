// Which part of an input each face belongs to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell::repair {

/// Parts in the order of their first faces.
struct Parts {
  std::vector<uint32_t> of_face;
  std::vector<std::string> name;  ///< of each part; empty: it has none

  size_t count() const { return name.size(); }
};

/// Faces that are connected through edges: an edge of more than two connects those that have a solid between them, so
/// that solids that share vertices stay apart. Edges that one face alone has, as where each face has its own vertices,
/// are matched by position. Their names are those of groups, or else of objects, that have all their faces. Cost: a
/// sort of the edges, and of the vertices where faces have edges alone. Throws:
/// interrupted.
Parts find_components(const TriangleSoup& soup, const Context& context);

/// Faces that have the same value of an attribute of faces, named by it; "groups" is the attribute "group", or else
/// "object". Throws: usage for an attribute that is not there, or not of faces.
Parts find_parts_by(const TriangleSoup& soup, const std::string& attribute);

}  // namespace isoshell::repair
