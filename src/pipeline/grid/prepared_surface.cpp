// See prepared_surface.h.
#include "pipeline/grid/prepared_surface.h"

#include <utility>

namespace isoshell {

PreparedSurface begin_with(LatticeSurface surface, const RemeshOptions& checked_options) {
  PreparedSurface p;
  p.options = checked_options;
  p.surface = std::move(surface);
  p.target = p.target_of_input = target_of(checked_options, p.surface.topology.area_world);
  return p;
}

void set_target(PreparedSurface& p) {
  if (p.vertices_of_lengths)
    p.target = target_of(*p.vertices_of_lengths, p.surface.topology.area_world);
  else if (p.options.edge_length_world && has_sheet(p))
    p.target.vertices = target_of(p.options, sheet_area_world(p.sheet)).vertices;
}

double edge_length_on_sheet_world(const PreparedSurface& p) {
  return target_of(p.options, sheet_area_world(p.sheet)).edge_length_world;
}

Prepared PreparedParts::hold(PreparedSurface parts) {
  return Prepared(std::make_shared<PreparedSurface>(std::move(parts)));
}

Prepared::Prepared(std::shared_ptr<PreparedSurface> parts) : parts_(std::move(parts)) {}
const LatticeSurface& Prepared::surface() const { return parts_->surface; }
const SiteSet& Prepared::sites() const { return parts_->sites; }
const SiteSamples& Prepared::samples() const { return parts_->samples; }
const Shell& Prepared::shell() const { return parts_->shell; }
const Sheet& Prepared::sheet() const { return parts_->sheet; }
int32_t Prepared::closing_vox() const { return parts_->closing_vox; }
bool Prepared::is_in_patches() const { return parts_->cut != nullptr; }
bool Prepared::has_bridges() const { return parts_->closing_vox > 0 && !parts_->grown; }
const RemeshReport& Prepared::report() const { return parts_->report; }
void Prepared::free_samples() { parts_->samples = {}; }

}  // namespace isoshell
