// place_seeds: checks its arguments, then runs on the backend that the context asks for.
#include <algorithm>
#include <cmath>
#include <string>

#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

SeedSet place_seeds(const Sheet& sheet, const SeedOptions& options, Context& context) {
  const int64_t fewest = 4 * std::max<int64_t>(1, sheet.topology.components), most = sheet.vertex_count() / 2;
  if (options.count < fewest)
    throw Error(ErrorCode::usage, "seeds",
                std::to_string(options.count) + " vertices are too few: the surface's " +
                    std::to_string(sheet.topology.components) + " components need at least " + std::to_string(fewest));
  if (options.count > most) {
    const double factor = std::sqrt(double(options.count) / double(std::max<int64_t>(1, most)));
    throw Error(ErrorCode::usage, "seeds",
                std::to_string(options.count) + " vertices are too many for resolution " +
                    std::to_string(sheet.frame.resolution) + ", which can carry " + std::to_string(most) +
                    "; use a resolution of at least " +
                    std::to_string(int64_t(std::ceil(sheet.frame.resolution * factor))));
  }
  return backend_for(context).place_seeds_on_sheet(sheet, options, context);
}

SeedSet place_seeds(const SiteSet& sites, const SiteSamples& samples, const SeedOptions& options, Context& context) {
  return backend_for(context).place_seeds_on_sites(sites, samples, options, context);
}

}  // namespace isoshell
