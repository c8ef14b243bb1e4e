// Triangles that are too thin to be anything.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell::repair {

/// Collapses edges shorter than `thinnest` and flips the longest edges of triangles that are lower than that, as long
/// as the mesh, which is closed, stays the manifold that it is. Vertices stay where they are, or become others. Faces
/// keep their order, and their sources.
void drop_slivers(const std::vector<WorldPoint>& point, std::vector<std::array<uint32_t, 3>>& face,
                  std::vector<uint32_t>& source, double thinnest);

}  // namespace isoshell::repair
