// build_level_set and its surface: check arguments, then run on the backend that the context asks for.
#include "isoshell/advanced/level_set.h"

#include <string>

#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

LevelSetSurface level_set_surface(const LatticeSurface& surface, const TriangleSoup* exact, const Sheet& sheet,
                                  SheetPart part, Context& context) {
  return backend_for(context).level_set_surface(surface, exact, sheet, part, context);
}

LevelSet build_level_set(const LevelSetSurface& surface, const SiteSet& sites, const Sheet& sheet,
                         const LevelSetOptions& options, Context& context) {
  if (!(options.band_vox >= 1 && options.band_vox <= kMaxLevelSetBandVox))
    throw Error(ErrorCode::usage, "level-set",
                "band_vox is " + std::to_string(options.band_vox) + "; it must be 1 to " +
                    std::to_string(int(kMaxLevelSetBandVox)));
  return backend_for(context).build_level_set(surface, sites, sheet, options, context);
}

}  // namespace isoshell
