// See relax_meanwhile.h.
#include "pipeline/sheet/relax_meanwhile.h"

#include <utility>

#include "isoshell/error.h"
#include "pipeline/grid/choose_grid.h"
#include "pipeline/grid/timed.h"
#include "pipeline/sheet/crease_search.h"
#include "pipeline/sheet/warm_start.h"
#include "voxel/exact_int.h"

namespace isoshell {

namespace {

RelaxedSeeds from_previous(const Prepared& prepared, const RemeshOptions& options, Context& context) {
  return relax_from_previous(prepared.sheet, *options.previous, vertex_target(options, prepared),
                             relax_options(options), options.tolerance.has_value(), context);
}

/// What was relaxed meanwhile by these options from this frame, once; no seeds where there is no such.
RelaxedSeeds take_relaxed(const Prepared& prepared, const LevelOptions& options, const PreviousFrame* previous) {
  RelaxedMeanwhile* const made = prepared.relaxed.get();
  if (!made || made->previous.get() != previous || !(made->options == options)) return {};
  return std::exchange(made->relaxed, {});
}

}  // namespace

RelaxOptions relax_options(const RemeshOptions& options) {
  RelaxOptions relax;
  relax.max_passes = options.max_passes.value_or(options.method == Method::shell ? 200 : 100);
  if (options.tolerance) relax.tolerance_ppb = int32_t(*options.tolerance * 1e9);
  if (options.max_step_vox) relax.max_step_q8 = int32_t(*options.max_step_vox * kOneVoxelQ8);
  return relax;
}

LevelOptions level_options(const Prepared& prepared, const RemeshOptions& options) {
  return {{vertex_target(options, prepared), options.seed}, relax_options(options), options.tolerance.has_value()};
}

void relax_meanwhile(const RemeshOptions& options, Prepared& prepared, RemeshReport& report, Context& context) {
  const std::shared_ptr<CreaseSearch> search = prepared.creases;
  if (!search || !search->goes_on()) return;
  RelaxedMeanwhile made{level_options(prepared, options), prepared.previous, {}};
  try {
    made.relaxed = timed(report, "relax", context, [&] {
      return made.previous
                 ? from_previous(prepared, options, context)
                 : relax_by_levels(prepared, made.options, context, [&] { return search->has_found_curves(); });
    });
  } catch (const Error& error) {  // what may not be needed at all may fail for want of room or memory
    const bool wants_room = dynamic_cast<const NoRoom*>(&error) || error.code() == ErrorCode::out_of_memory;
    if (!wants_room) throw;
  }
  if (made.relaxed.seeds.size() > 0 && !search->has_found_curves())
    prepared.relaxed = std::make_shared<RelaxedMeanwhile>(std::move(made));
}

RelaxedSeeds relaxed_by_levels(const Prepared& prepared, const RemeshOptions& options, Context& context) {
  const LevelOptions levels = level_options(prepared, options);
  RelaxedSeeds meanwhile = take_relaxed(prepared, levels, nullptr);
  return meanwhile.seeds.size() > 0 ? std::move(meanwhile) : relax_by_levels(prepared, levels, context);
}

RelaxedSeeds relaxed_from_previous(const Prepared& prepared, const RemeshOptions& options, Context& context) {
  RelaxedSeeds meanwhile = take_relaxed(prepared, level_options(prepared, options), options.previous.get());
  return meanwhile.seeds.size() > 0 ? std::move(meanwhile) : from_previous(prepared, options, context);
}

}  // namespace isoshell
