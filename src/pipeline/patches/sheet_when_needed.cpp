// See sheet_when_needed.h.
#include "pipeline/patches/sheet_when_needed.h"

#include <utility>

#include "core/copy_product.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/sheet/prepare_surface.h"
#include "pipeline/sheet/warm_start.h"

namespace isoshell {

bool may_be_cut_at_once(const Plan& plan, bool has_caps) {
  const RemeshOptions& options = plan.options;
  const InputTopology& input = plan.input;
  const bool needs_sheet = options.method != Method::sheet || options.want_shell || wants_lengths(options) ||
                           options.edge_length_world || options.closing_vox || options.closing_world;
  return options.previous && !needs_sheet && input.closed && input.oriented && !has_caps &&
         shows_most_handles(plan.target.vertices, input);
}

std::optional<PreparedSurface> prepare_patches_alone(LatticeSurface surface, const RemeshOptions& options,
                                                     const PatchSource& source, RemeshReport& report,
                                                     Context& context) {
  PreparedSurface p = begin_with(std::move(surface), options);
  RemeshReport tried = report;
  tried.coherence.why_cold = choose_beginning(p);
  if (!p.previous) return {};
  cut_into_patches(source, p, tried, context);
  if (!is_on_own_triangles(p)) {
    report.times = std::move(tried.times);
    return {};
  }
  report = std::move(tried);
  return p;
}

const PreparedSurface& SheetWhenNeeded::get(RemeshReport& report) {
  if (has_sheet(prepared_)) return prepared_;
  if (!made_) {
    RemeshOptions options = prepared_.options;
    options.features.creases = Features::Creases::off;  // they are cut along already
    options.previous.reset();                           // it is said already how the frame begins
    made_ = prepare_surface(host_copy(prepared_.surface), 0, options, report, context_);
    made_->previous = prepared_.previous;
    made_->cut = prepared_.cut;
    report_sheet(*made_, report);
  }
  return *made_;
}

}  // namespace isoshell
