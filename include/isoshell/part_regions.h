// From the parts of a mesh to the regions that they are, and the walls between them.
#pragma once

#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// What --regions makes of an input.
struct PartRegions {
  TriangleSoup walls;  ///< each once, with its regions; without attributes
  std::vector<std::string> warnings;
};

/// Parts are the connected components of the faces ("components"), their groups ("groups") or what has the same value
/// of an attribute of faces (its name). Those that are closed become regions 1, 2, ... in the order of the input, with
/// their names; where they overlap the first one keeps the space. A component that looks inward is the hollow of the
/// smallest one around it. With "cells" every cell that faces enclose is a region of its own, by the order of their
/// positions. Walls between two regions are there once; those with one region on both sides stay where a part that is
/// open has them, and with "cells". Result: the same for every number of threads. Throws: usage for an attribute that
/// is not there, and for a soup that has regions; nothing_to_mesh; interrupted. Cost: sorts of vertices, faces and
/// edges.
PartRegions find_part_regions(const TriangleSoup& soup, const std::string& parts, Context& context);

}  // namespace isoshell
