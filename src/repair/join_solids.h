// The union of closed solids as one mesh, for those that pass through or touch each other.
#pragma once

#include <optional>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell::repair {

struct JoinedSolids {
  TriangleSoup soup;
  int64_t cut_faces = 0;
};

/// The faces that bound the union of a soup's components, cut where these pass through each other, closed and without
/// an edge of more than two faces. Sides are decided exactly, on a grid of 2^28 steps along the longest side, and with
/// each component swollen by up to two millionths of that: so solids that touch are joined, and of two walls in one
/// plane one is the outer one. Points of the soup stay where they are. Slivers thinner than eight millionths, as they
/// stay where walls are nearly in one plane, are removed. None where no components meet, one is not closed or looks
/// inward, or rounding leaves lines that cross. Result: independent of threads. Cost: for n components about log n
/// times their faces.
std::optional<JoinedSolids> join_solids(const TriangleSoup& soup, const Context& context);

}  // namespace isoshell::repair
