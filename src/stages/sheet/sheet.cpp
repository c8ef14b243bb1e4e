// build_sheet: checks its arguments, then runs on the backend that the context asks for.
#include <algorithm>

#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "stages/require_surface.h"

namespace isoshell {

namespace {

void require_sheet_options(const SiteSet& sites, const SheetOptions& options) {
  if (options.closing_vox < 0 || options.closing_vox > kMaxClosingVox)
    throw Error(ErrorCode::usage, "sheet",
                "closing_vox is " + std::to_string(options.closing_vox) + "; it must be 0 to " +
                    std::to_string(kMaxClosingVox));
  if (sites.voxels.voxel_count() == 0)
    throw Error(ErrorCode::nothing_to_mesh, "sheet", "there are no sites; the surface is empty");
}

Sheet sheet_of_genus(const LatticeSurface& surface, const SiteSet& sites, const SiteSamples& samples,
                     SiteSamples* spent, const SheetOptions& options, Context& context) {
  require_sheet_options(sites, options);
  const BackendTable& backend = backend_for(context);
  const auto build = [&](const SiteSet& solid_voxels, int64_t genus, SiteSamples* spent_there) {
    SheetOptions at_most = options;
    at_most.genus = genus;
    return backend.build_sheet(surface, solid_voxels, sites, samples, spent_there, at_most, context);
  };
  const int64_t genus = options.closing_vox > 0 ? kNoGenus : options.genus;
  Sheet sheet = build(sites, genus, spent);
  if (genus == kNoGenus || sheet.topology.genus <= std::max<int64_t>(0, genus)) return sheet;
  const SiteSet solid_voxels = backend.cut_false_handles(sites, samples, genus, context);
  if (solid_voxels.voxels.voxel_count() > 0) {
    Sheet cut = build(solid_voxels, genus == kUnknownGenus ? sheet.topology.genus - 1 : genus, nullptr);
    const int64_t handles = sheet.topology.genus - cut.topology.genus;
    const bool is_right = genus == kUnknownGenus ? handles > 0 : cut.topology.genus == genus;
    if (cut.topology.components == sheet.topology.components && is_right) {
      cut.topology.cut_handles = handles;
      return cut;
    }
  }
  return sheet.position.empty() ? build(sites, kNoGenus, spent) : std::move(sheet);
}

}  // namespace

Sheet build_sheet(const LatticeSurface& surface, const SiteSet& sites, const SiteSamples& samples,
                  const SheetOptions& options, Context& context) {
  return sheet_of_genus(surface, sites, samples, nullptr, options, context);
}
Sheet build_sheet(const LatticeSurface& surface, const SiteSet& sites, SiteSamples&& samples,
                  const SheetOptions& options, Context& context) {
  return sheet_of_genus(surface, sites, samples, &samples, options, context);
}

SiteSet coarsen_sites(const SiteSet& sites, Context& context) {
  return backend_for(context).coarsen_sites(sites, context);
}

Sheet build_proxy(const SiteSet& sites, const LatticeFrame& frame, const SheetOptions& options, Context& context) {
  require_sheet_options(sites, options);
  return backend_for(context).build_proxy(sites, frame, options, context);
}

int64_t six_volume_vox(const SurfaceMesh& surface, Context& context) {
  require_closed(surface, "sheet");
  return backend_for(context).six_volume_vox(surface, context);
}

}  // namespace isoshell
