// subdivide_seeds: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "stages/require_surface.h"

namespace isoshell {

SeedSet subdivide_seeds(const SurfaceMesh& surface, const DualMesh& mesh, const SeedSet& seeds, int64_t target,
                        Context& context) {
  require_closed(surface, "subdivide");
  require_homes(surface, seeds, "subdivide");
  const int64_t most = seeds.size() + mesh.triangles.size() / 2 * 5;
  if (target < seeds.size() || target > most)
    throw Error(ErrorCode::usage, "subdivide",
                "target is " + std::to_string(target) + "; it must be " + std::to_string(seeds.size()) + " to " +
                    std::to_string(most) + " for this mesh");
  return backend_for(context).subdivide_seeds(surface, mesh, seeds, target, context);
}

SeededMesh collapse_edges(const SurfaceMesh& surface, SeededMesh&& mesh, const CollapseOptions& options,
                          Context& context) {
  require_closed_or_fixed(surface, mesh.seeds, "collapse");
  backend_for(context).collapse_edges(surface, options, mesh.seeds, mesh.mesh, context);
  return std::move(mesh);
}

}  // namespace isoshell
