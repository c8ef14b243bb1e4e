// Pieces of triangles as few as their outlines need.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/box.h"
#include "isoshell/backend.h"

namespace isoshell::repair {

/// Faces of a surface, which are whole triangles or pieces of them.
struct PiecedFaces {
  std::vector<WorldPoint> point;  ///< ascending, once each
  std::vector<std::array<uint32_t, 3>> face;
  std::vector<uint32_t> source;   ///< per face the triangle that it is a piece of
  std::vector<uint8_t> is_piece;  ///< per face: it is not all of it
};

/// What is left of a triangle, and of others of its kind beside it in its plane, is triangulated again between its
/// borders with other triangles, and of the smallest of them then; where there is no piece, all stays. `kind` is per
/// triangle. Points in it go, and those in straight borders of two triangles, which earlier cuts have left; those that
/// `is_kept` stay, as do points that are more than some steps of the lattice in this box off. Pieces that have no such
/// triangulation stay as they are, and so do those whose new triangles would intersect others, which is decided
/// exactly. Throws: interrupted. Cost: a sort of the edges, and for each triangle of several pieces n sqrt n in their
/// number.
void dissolve_cuts(PiecedFaces& faces, const std::vector<uint32_t>& kind, const std::vector<uint8_t>& is_kept,
                   const WorldBox& box, const Context& context);

}  // namespace isoshell::repair
