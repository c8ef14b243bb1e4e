// place_seeds: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

SeedSet place_seeds(const Sheet& sheet, const SeedOptions& options, Context& context) {
  return backend_for(context).place_seeds_on_sheet(sheet, options, context);
}

SeedSet place_seeds(const SiteSet& sites, const SiteSamples& samples, const SeedOptions& options, Context& context) {
  return backend_for(context).place_seeds_on_sites(sites, samples, options, context);
}

}  // namespace isoshell
