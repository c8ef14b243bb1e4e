// optimize_mesh: runs on the backend that the context asks for.
#include "stages/backend_table.h"

namespace isoshell {

OptimizeReport optimize_mesh(const Sheet& sheet, const OptimizeOptions& options, SeedSet& seeds, DualMesh& mesh,
                             Context& context) {
  return backend_for(context).optimize_mesh(sheet, options, seeds, mesh, context);
}

}  // namespace isoshell
