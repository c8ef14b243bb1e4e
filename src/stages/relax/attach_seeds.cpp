// attach_to_sheet: checks its arguments, then runs on the backend that the context asks for.
#include <string>

#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

SeedSet attach_to_sheet(const SurfaceMesh& surface, SeedSet&& seeds, int halvings, Context& context) {
  if (surface.vertex_count() == 0)
    throw Error(ErrorCode::usage, "attach", "the sheet has no vertices; seeds need at least one to sit on");
  if (seeds.fixed.count > 0)
    throw Error(ErrorCode::usage, "attach",
                std::to_string(seeds.fixed.count) + " of the " + std::to_string(seeds.size()) +
                    " seeds are fixed, and would move off the vertices that they sit on; attach 0 fixed seeds, and put "
                    "those of this surface before the others then");
  backend_for(context).attach_to_sheet(surface, seeds, halvings, context);
  return std::move(seeds);
}

}  // namespace isoshell
