// attach_to_sheet: runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

SeedSet attach_to_sheet(const SurfaceMesh& surface, SeedSet&& seeds, int halvings, Context& context) {
  if (surface.vertex_count() == 0)
    throw Error(ErrorCode::usage, "attach", "the sheet has no vertices; seeds need at least one to sit on");
  backend_for(context).attach_to_sheet(surface, seeds, halvings, context);
  return std::move(seeds);
}

}  // namespace isoshell
