// Two solids whose surfaces pass through each other, cut along the lines where they do.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell::repair {

/// Coordinates are whole numbers from 0 to kLargestInPlane, so that sides are decided exactly.
struct Solid {
  std::vector<WorldPoint> point;
  std::vector<uint32_t> origin;  ///< per point its vertex in the mesh; kNoFace where surfaces cross
  std::vector<std::array<uint32_t, 3>> face;
  std::vector<uint32_t> source;  ///< per face
};

/// The faces of both on the points of both and the new ones: each is cut along the other's.
struct CutSolids {
  Solid both;
  int64_t faces_of_first = 0;
  int64_t cut_faces = 0;                          ///< of the two
  std::vector<std::array<uint32_t, 2>> crossing;  ///< edges where they cross, smaller end first, ascending
};

/// None where a point of one lies in a face of the other or two edges meet, or where rounding makes lines cross; then
/// `failed_at` is a corner of a face there. No lines are where no faces cross. Cost: pairs of faces whose boxes meet.
std::optional<CutSolids> cut_solids(const Solid& a, const Solid& b, WorldPoint& failed_at, const Context& context);

}  // namespace isoshell::repair
