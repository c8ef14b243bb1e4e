// relax_on_sheet: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "stages/relax/relax_options.h"
#include "stages/require_seeds.h"
#include "stages/require_surface.h"

namespace isoshell {

RelaxedSeeds relax_on_sheet(const SurfaceMesh& surface, SeedSet&& seeds, const RelaxOptions& options,
                            Context& context) {
  if (seeds.size() == 0)
    throw Error(ErrorCode::usage, "relax", "there are 0 seeds; relaxation needs at least 1: see place_seeds");
  require_relax_options(options);
  require_blocks(surface, "relax");
  require_fixed_seeds(surface, seeds, "relax");
  RelaxReport report = backend_for(context).relax_on_sheet(surface, seeds, options, context);
  return {std::move(seeds), std::move(report)};
}

}  // namespace isoshell
