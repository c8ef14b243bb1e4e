// build_level_set: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/advanced/level_set.h"

#include <string>
#include <vector>

#include "core/copy_product.h"
#include "core/vector_view.h"
#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {
namespace {

/// From a position of the lattice, and from one of the world.
struct ToVoxels {
  const LatticeFrame& frame;

  WorldPoint operator()(PointQ8 q) const {
    constexpr double kStep = 1.0 / kOneVoxelQ8;
    return {q.x * kStep, q.y * kStep, q.z * kStep};
  }
  WorldPoint operator()(const WorldPoint& p) const {
    return {(p.x - frame.origin.x) / frame.voxel_size, (p.y - frame.origin.y) / frame.voxel_size,
            (p.z - frame.origin.z) / frame.voxel_size};
  }
};

}  // namespace

LevelSetSurface level_set_surface(const LatticeSurface& surface_anywhere, const TriangleSoup* exact,
                                  const Sheet& sheet_anywhere, SheetPart part) {
  const OnHost<LatticeSurface> surface_here(surface_anywhere);
  const OnHost<Sheet> sheet_here(sheet_anywhere);
  const LatticeSurface& surface = *surface_here;
  const Sheet& sheet = *sheet_here;
  const ToVoxels to_voxels{sheet.frame};
  std::vector<WorldPoint> corner;
  const auto add = [&](const auto& positions, uint32_t a, uint32_t b, uint32_t c) {
    for (const uint32_t v : {a, b, c}) corner.push_back(to_voxels(positions[v]));
  };
  if (part != SheetPart::alone) {
    corner.reserve(size_t(3 * surface.triangles.size()));
    for (int64_t i = 0; i < surface.triangles.size(); ++i) {
      const TriangleIndices t = surface.triangles[i];
      if (!exact) {
        add(surface.points, t.a, t.b, t.c);
        continue;
      }
      const auto& source = exact->triangles[surface.source_face[i]];
      add(exact->vertices, source[0], source[1], source[2]);
    }
  }
  LevelSetSurface made;
  made.first_of_sheet = int64_t(corner.size() / 3);
  for (int64_t i = 0; i < sheet.triangles.size() && part != SheetPart::none; ++i)
    add(sheet.position, sheet.triangles[i].a, sheet.triangles[i].b, sheet.triangles[i].c);
  made.corner = buffer_of(corner);
  return made;
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
