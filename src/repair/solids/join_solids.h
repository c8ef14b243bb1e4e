// The union of closed solids as one mesh, for those that pass through or touch each other.
#pragma once

#include <optional>

#include "isoshell/boolean_union.h"

namespace isoshell::repair {

struct JoinedSolids {
  TriangleSoup soup;
  int64_t cut_faces = 0;
};

/// The faces that bound the union of a soup's closed components that look outward, cut where these pass through each
/// other, closed and without an edge of more than two faces. Sides are decided exactly, on a grid of 2^28 steps along
/// the longest side, and with each component swollen by up to two millionths of that: so solids that touch are joined,
/// and of two walls in one plane one is the outer one. Points of the soup stay where they are. Slivers thinner than
/// eight millionths, as they stay where walls are nearly in one plane, are removed. Components that are open or look
/// inward stay as they are. None where no others meet; nor where rounding leaves lines that cross, a component crosses
/// itself, or those that would stay meet the others or lie in more than one: the report says so. Result: independent of
/// threads. Cost: for n components about log n times their faces.
std::optional<JoinedSolids> join_solids(const TriangleSoup& soup, JoinReport& report, const Context& context);

}  // namespace isoshell::repair
