// From the parts of a mesh to the regions that they are, and the walls between them.
#pragma once

#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/remesh_options.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// How a mesh is parted.
struct PartOptions {
  /// The connected components of the faces ("components"), their groups ("groups"), what has the same value of an
  /// attribute of faces (its name), or the cells that faces enclose ("cells").
  std::string parts;
  double near_world = 0;  ///< what is nearer is made one; so is what is nearer than 2^-21 of the longest side
  double thin_world = 0;  ///< cells that are thinner, twice their volume over their area, belong to those beside them
  double gap_world = 0;   ///< regions that are nearer than that and share no wall are named
};
/// As a run with these options parts it: what rounding to its lattice would make meet is one, and what it would turn
/// over is no region. Throws: as remesh() for its count and edge length. Cost: linear.
PartOptions part_options(const RemeshOptions& options, const TriangleSoup& soup);

/// What --regions makes of an input.
struct PartRegions {
  TriangleSoup walls;  ///< each once, with its regions; without attributes
  std::vector<std::string> warnings;
};

/// Parts that are closed become regions 1, 2, ... in the order of the input, with their names; where they overlap the
/// first one keeps the space, and one that lies in another keeps its own. A component that looks inward is the hollow
/// of the smallest one around it. With "cells" every cell that faces enclose is a region of its own, by the order of
/// their positions. Walls between two regions are there once; those with one region on both sides stay where a part
/// that is open has them, and with "cells". Result: the same for every number of threads. Throws: usage for an
/// attribute that is not there, and for a soup that has regions; nothing_to_mesh; interrupted. Cost: sorts of vertices,
/// faces and edges.
PartRegions find_part_regions(const TriangleSoup& soup, const PartOptions& options, Context& context);

}  // namespace isoshell
