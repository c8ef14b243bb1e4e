// improve_mesh: runs on the backend that the context asks for.
#include "stages/backend_table.h"

namespace isoshell {

PostReport improve_mesh(const Sheet& sheet, const PostOptions& options, SeedSet& seeds, DualMesh& mesh,
                        Context& context) {
  return backend_for(context).improve_mesh(sheet, options, seeds, mesh, context);
}

}  // namespace isoshell
