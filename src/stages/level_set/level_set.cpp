// build_level_set: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/advanced/level_set.h"

#include <string>

#include "core/copy_product.h"
#include "core/parallel_ranges.h"
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
  const int64_t of_input = part == SheetPart::alone ? 0 : surface.triangles.size(),
                of_sheet = part == SheetPart::none ? 0 : sheet.triangles.size();
  LevelSetSurface made{Buffer<WorldPoint>(3 * (of_input + of_sheet)), of_input};
  const auto put = [&](int64_t triangle, const auto& positions, uint32_t a, uint32_t b, uint32_t c) {
    WorldPoint* const corner = made.corner.data() + 3 * triangle;
    corner[0] = to_voxels(positions[a]), corner[1] = to_voxels(positions[b]), corner[2] = to_voxels(positions[c]);
  };
  for_each_index(int64_t(0), of_input, [&](int64_t i) {
    const TriangleIndices t = surface.triangles[i];
    if (!exact) return put(i, surface.points, t.a, t.b, t.c);
    const auto& source = exact->triangles[surface.source_face[i]];
    put(i, exact->vertices, source[0], source[1], source[2]);
  });
  for_each_index(int64_t(0), of_sheet, [&](int64_t i) {
    const TriangleIndices t = sheet.triangles[i];
    put(of_input + i, sheet.position, t.a, t.b, t.c);
  });
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
