// Loops that lie in a plane, as those do that pieces of a flat face left.
#pragma once

#include <optional>

#include "geometry/world_vector.h"
#include "repair/holes/repair_loops.h"

namespace isoshell::repair {

/// A plane's loop, seen as what a flat face would close.
struct FlatRim {
  WorldPoint at, normal;  ///< the plane; of length 1, as the face would have it
  double area = 0;        ///< with the loop's sign, so never below 0
  double tolerance = 0;   ///< what is nearer to the plane is in it

  double height(const WorldPoint& p) const { return dot(p - at, normal); }
  bool holds(const WorldPoint& p) const { return std::abs(height(p)) <= tolerance; }
};
std::optional<FlatRim> flat_rim(const RepairMesh& mesh, const Loop& loop);

/// Whether pieces of a face are missing of which others are there: along a third of the loop or more, but not all of
/// it, the faces at it lie in its plane and look the same way. An opening that someone made is all in a face, or ends
/// on a straight or round side of it; where triangles are missing the outline of the face turns.
bool is_piece_of_face(const RepairMesh& mesh, const Loop& loop, const FlatRim& rim);

}  // namespace isoshell::repair
