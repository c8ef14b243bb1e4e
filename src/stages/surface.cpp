// From a soup in world units to the canonical surface on the lattice. Runs on the host.
#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

InputTopology measure_topology(const TriangleSoup&, DirtCounts&, Context&) {
  throw Error(ErrorCode::internal, "surface", "measure_topology is missing");
}

LatticeSurface snap_surface(const TriangleSoup&, const LatticeFrame&, Context&) {
  throw Error(ErrorCode::internal, "surface", "snap_surface is missing");
}

}  // namespace isoshell
