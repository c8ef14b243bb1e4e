// Where the triangles of a mesh on the lattice intersect one another.
#pragma once

#include <array>
#include <atomic>
#include <vector>

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/backend.h"
#include "measure/box_tree.h"

namespace isoshell {

/// The pairs of triangles that meet outside of the corners that they share, exactly tested; ascending, the smaller one
/// first. `joined`: of the first vertices the one that each is a copy of (see FixedSeeds). Some are missing once `stop`
/// is set. Cost: a tree of boxes, for every few triangles a walk down it, and a look at all pairs whose boxes meet.
std::vector<std::array<uint32_t, 2>> crossing_pairs(View<const PointQ8> position, View<const TriangleIndices> triangles,
                                                    View<const uint32_t> joined, const std::atomic<bool>& stop);

/// What the boxes of two triangles have in common.
BoxQ8 common_box(View<const PointQ8> position, View<const TriangleIndices> triangles,
                 const std::array<uint32_t, 2>& pair);

/// Of each of these pairs the box that those of both triangles have in common. Throws: interrupted.
std::vector<BoxQ8> find_crossings(View<const PointQ8> position, View<const TriangleIndices> triangles,
                                  Context& context);

/// Which of the boxes are farther than this, along some axis, from each of the others; ascending.
std::vector<size_t> which_apart(const std::vector<BoxQ8>& boxes, const std::vector<BoxQ8>& others, int32_t reach_q8);

}  // namespace isoshell
