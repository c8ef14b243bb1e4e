// measure_topology and snap_surface: host code on every backend, since world units end here.
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/surface_body.h"
#include "stages/topology_body.h"

namespace isoshell {

InputTopology cpu_measure_topology(const TriangleSoup& soup, DirtCounts& dirt, Context& context) {
  TbbExecutor exec(context, "surface");
  return run_with_threads(context, [&] { return measure_topology_body(exec, soup, dirt); });
}

LatticeSurface cpu_snap_surface(const TriangleSoup& soup, const LatticeFrame& frame, Context& context) {
  TbbExecutor exec(context, "surface");
  return run_with_threads(context, [&] { return snap_surface_body(exec, soup, frame); });
}

}  // namespace isoshell
