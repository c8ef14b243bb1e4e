// relax_in_shell: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "stages/relax/relax_options.h"

namespace isoshell {

RelaxedSeeds relax_in_shell(const Shell& shell, const SiteSet& sites, const SiteSamples& samples, SeedSet&& seeds,
                            const RelaxOptions& options, Context& context) {
  if (seeds.size() == 0) throw Error(ErrorCode::usage, "relax", "there are no seeds; place at least 4");
  require_relax_options(options);
  RelaxReport report = backend_for(context).relax_in_shell(shell, sites, samples, seeds, options, context);
  return {std::move(seeds), std::move(report)};
}

}  // namespace isoshell
