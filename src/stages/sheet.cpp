// build_sheet: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

Sheet build_sheet(const LatticeSurface& surface, const SiteSet& sites, const SiteSamples& samples, const SheetOptions& options, Context& context) {
  return backend_for(context).build_sheet(surface, sites, samples, options, context);
}

}  // namespace isoshell
