// Solids on a grid of whole steps, each a little larger than it is.
#pragma once

#include "repair/holes/repair_mesh.h"
#include "repair/solids/cut_solids.h"

namespace isoshell::repair {

/// From the corners of faces to whole steps from 0 on.
struct Steps {
  WorldPoint least;
  double a_step;

  explicit Steps(const RepairMesh& mesh);
  WorldPoint from(const WorldPoint& p) const;
  WorldPoint to_world(const WorldPoint& s) const;
};

/// Gives a solid its points in steps: moved outward by up to two millionths of the mesh's size, and each a few steps
/// off. By what depends on the seed.
void swell(Solid& solid, const std::vector<WorldPoint>& position, const Steps& steps, uint64_t seed);

}  // namespace isoshell::repair
