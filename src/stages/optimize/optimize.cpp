// optimize_mesh: runs on the backend that the context asks for.
#include "stages/backend_table.h"
#include "stages/require_surface.h"

namespace isoshell {

OptimizedMesh optimize_mesh(const SurfaceMesh& surface, SeededMesh&& mesh, const OptimizeOptions& options,
                            Context& context) {
  require_closed_or_fixed(surface, mesh.seeds, "optimize");
  require_blocks(surface, "optimize");
  const OptimizeReport report = backend_for(context).optimize_mesh(surface, options, mesh.seeds, mesh.mesh, context);
  return {std::move(mesh), report};
}

}  // namespace isoshell
