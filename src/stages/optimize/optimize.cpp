// optimize_mesh: runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "stages/require_surface.h"

namespace isoshell {

OptimizedMesh optimize_mesh(const SurfaceMesh& surface, SeededMesh&& mesh, const OptimizeOptions& options,
                            Context& context) {
  require_closed_or_fixed(surface, mesh.seeds, "optimize");
  require_blocks(surface, "optimize");
  if (options.mesh_passes > 0 && (!options.for_seeds || options.keep_apart))
    throw Error(ErrorCode::usage, "optimize",
                "mesh_passes is " + std::to_string(options.mesh_passes) +
                    "; such passes are for vertices that are to be seeds: set for_seeds, without keep_apart");
  const OptimizeReport report = backend_for(context).optimize_mesh(surface, options, mesh.seeds, mesh.mesh, context);
  return {std::move(mesh), report};
}

}  // namespace isoshell
