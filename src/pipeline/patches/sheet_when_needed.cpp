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

bool may_be_on_own_triangles(const PreparedSurface& p) {
  const RemeshOptions& options = p.options;
  const InputTopology& input = p.surface.topology;
  const bool closes_gaps = options.closing_vox.value_or(0) > 0 || options.closing_world.value_or(0) > 0;
  const bool may_keep_seeds = options.want_shell && options.features.creases == Features::Creases::off;
  return options.method == Method::sheet && !options.previous && !closes_gaps && !may_keep_seeds && input.oriented &&
         p.surface.first_cap == kNone && can_compare(input) && shows_all_parts(p.target_of_input.vertices, input);
}

std::optional<PreparedSurface> prepare_patches_alone(LatticeSurface surface, const RemeshOptions& options,
                                                     const PatchSource& source, Run& run) {
  PreparedSurface p = begin_with(std::move(surface), options);
  p.report.coherence.why_cold = choose_beginning(p);
  if (!p.previous) return {};
  const size_t warnings = run.warnings.size();
  const int64_t bytes = run.memory_estimate_bytes;
  cut_into_patches(source, p, run);
  if (is_on_own_triangles(p)) return p;
  run.warnings.resize(warnings);
  run.memory_estimate_bytes = bytes;
  return {};
}

const PreparedSurface& SheetWhenNeeded::get() {
  if (has_sheet(prepared_)) return prepared_;
  if (!made_) {
    RemeshOptions options = prepared_.options;
    options.features.creases = Features::Creases::off;  // they are cut along already
    options.previous.reset();                           // it is said already how the frame begins
    made_ = prepare_surface(host_copy(prepared_.surface), 0, options, run_);
    made_->previous = prepared_.previous;
    made_->cut = prepared_.cut;
    made_->report = prepared_.report;
    report_sheet(*made_);
  }
  return *made_;
}

}  // namespace isoshell
