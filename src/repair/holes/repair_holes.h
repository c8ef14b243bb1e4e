// Faces that close loops which are holes.
#pragma once

#include "repair/holes/repair_loops.h"
#include "repair/holes/repair_patches.h"

namespace isoshell::repair {

/// Which loops are closed.
struct Closing {
  bool holes = true;            ///< those that are holes, see repair_soup, and tubes
  double widest_gap_world = 0;  ///< otherwise those whose caps are this wide or less, whatever they bound
};

struct Cap {
  Loop loop;                  ///< what it closes; where that are several loops, one after the other
  std::vector<Corners> face;  ///< oriented like the faces around
  int loops = 1;
};
/// Caps of several loops each.
struct Joins {
  std::vector<Cap> tubes, faces;
};
/// Some loops without those that caps close.
std::vector<Loop> loops_but(const RepairMesh& mesh, const std::vector<Cap>& caps, std::vector<Loop> loops);

/// Closes loops, all but those that are joined, and counts those that stay open. Faces agree in their patches already.
/// Joins come first, then caps in the order of their smallest half-edges.
std::vector<Cap> cap_holes(const RepairMesh& mesh, Joins joins, const Closing& closing, RepairReport& report);

}  // namespace isoshell::repair
