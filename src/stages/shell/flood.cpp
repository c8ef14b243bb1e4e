// flood_shell: runs on the backend that the context asks for.
#include "stages/backend_table.h"

namespace isoshell {

VoronoiLabels flood_shell(const Shell& shell, const SeedSet& seeds, Context& context) {
  return backend_for(context).flood_shell(shell, seeds, context);
}

}  // namespace isoshell
