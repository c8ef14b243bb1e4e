// level_set (see remesh.h): of a prepared surface, on its grid.
#include "isoshell/advanced/level_set.h"

#include <optional>

#include "core/copy_product.h"
#include "isoshell/error.h"
#include "isoshell/remesh.h"
#include "pipeline/grid/prepared_surface.h"
#include "pipeline/patches/cut_curves.h"
#include "pipeline/patches/patches.h"
#include "pipeline/patches/sheet_when_needed.h"
#include "pipeline/sheet/prepare_surface.h"

namespace isoshell {
namespace {

constexpr int64_t kPlentyOfVertices = int64_t(1) << 26;  ///< none is placed

/// Of a surface whose walls were grown, as so few vertices could not show its parts, but which is cut along its curves
/// as it is.
PreparedSurface without_growth(const PreparedSurface& p, Run& run) {
  RemeshOptions options = p.options;
  options.vertices = kPlentyOfVertices;
  options.edge_length_world.reset();
  options.features.creases = Features::Creases::off;
  options.previous.reset();
  return prepare_surface(host_copy(p.surface), 0, options, run);
}

}  // namespace

LevelSet level_set(const Prepared& prepared, double band_vox, Context& context) {
  const PreparedSurface& given = PreparedParts::of(prepared);
  if (given.walls)
    throw Error(
        ErrorCode::usage, "level-set",
        "a level set is of one solid, and the input parts regions; remesh it without --regions, several level sets "
        "with --union, or labels one region after the other");
  Run run{context, false};
  SheetWhenNeeded sheet(given, run);
  std::optional<PreparedSurface> ungrown;
  if (given.grown && is_on_own_triangles(given)) ungrown = without_growth(given, run);
  const PreparedSurface& p = ungrown ? *ungrown : sheet.get();
  const bool may_bridge = !p.surface.topology.closed && p.closing_vox > 0;
  const SheetPart part = p.grown ? SheetPart::alone : may_bridge ? SheetPart::beside : SheetPart::none;
  const LevelSetSurface surface = level_set_surface(p.surface, given.exact.get(), p.sheet, part, context);
  return build_level_set(surface, p.grown ? p.grown.voxels : p.sites, p.sheet, {band_vox, p.closing_vox}, context);
}

}  // namespace isoshell
