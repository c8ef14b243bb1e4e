// sample_sites: runs on the backend that the context asks for.
#include "stages/backend_table.h"

namespace isoshell {

SiteSamples sample_sites(const LatticeSurface& surface, const SiteSet& sites, Context& context) {
  return backend_for(context).sample_sites(surface, sites, context);
}

}  // namespace isoshell
