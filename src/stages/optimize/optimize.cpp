// optimize_mesh: runs on the backend that the context asks for.
#include "stages/backend_table.h"
#include "stages/require_surface.h"

namespace isoshell {

OptimizeReport optimize_mesh(const SurfaceMesh& surface, const OptimizeOptions& options, SeedSet& seeds, DualMesh& mesh,
                             Context& context) {
  require_closed(surface, "optimize");
  require_blocks(surface, "optimize");
  return backend_for(context).optimize_mesh(surface, options, seeds, mesh, context);
}

}  // namespace isoshell
