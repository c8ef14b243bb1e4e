// level_set (see remesh.h): of a prepared surface, on its grid.
#include "isoshell/advanced/level_set.h"

#include "isoshell/error.h"
#include "isoshell/remesh.h"
#include "pipeline/grid/prepared_surface.h"
#include "pipeline/patches/sheet_when_needed.h"

namespace isoshell {

LevelSet level_set(const Prepared& prepared, double band_vox, Context& context) {
  const PreparedSurface& given = PreparedParts::of(prepared);
  if (given.walls)
    throw Error(
        ErrorCode::usage, "level-set",
        "a level set is of one solid, and the input parts regions; remesh it without --regions, several level sets "
        "with --union, or labels one region after the other");
  Run run{context, false};
  SheetWhenNeeded sheet(given, run);
  const PreparedSurface& p = sheet.get();
  const bool may_bridge = !p.surface.topology.closed && p.closing_vox > 0;
  const SheetPart part = p.grown ? SheetPart::alone : may_bridge ? SheetPart::beside : SheetPart::none;
  const LevelSetSurface surface = level_set_surface(p.surface, given.exact.get(), p.sheet, part, context);
  return build_level_set(surface, p.grown ? p.grown.voxels : p.sites, p.sheet, {band_vox, p.closing_vox}, context);
}

}  // namespace isoshell
