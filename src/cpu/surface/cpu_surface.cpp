// The CPU's measure_topology, snap_surface and make_surface_mesh.
#include "cpu/cpu_backend.h"
#include "cpu/surface/sort_keys.h"
#include "stages/surface/surface_body.h"
#include "stages/surface/surface_mesh_body.h"
#include "stages/surface/topology_body.h"

namespace isoshell {

InputTopology CpuBackend::measure_topology(const TriangleSoup& soup, DirtCounts& dirt, Context& context) const {
  CpuExecutor exec(context, "surface");
  return run_with_threads(context, [&] { return measure_topology_body(exec, view_of(soup), dirt); });
}

LatticeSurface CpuBackend::snap_surface(const TriangleSoup& soup, const LatticeFrame& frame, Context& context) const {
  CpuExecutor exec(context, "surface");
  return run_with_threads(context, [&] { return snap_surface_body(exec, view_of(soup), frame); });
}

MadeSurface CpuBackend::make_surface_mesh(const SurfaceTriangles& from, Context& context) const {
  CpuExecutor exec(context, "surface");
  return run_with_threads(context, [&] { return make_surface_mesh_body(exec, from); });
}

}  // namespace isoshell
