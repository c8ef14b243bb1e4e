// See relax_meanwhile.h.
#include "pipeline/sheet/relax_meanwhile.h"

#include <utility>

#include "isoshell/error.h"
#include "pipeline/sheet/crease_search.h"
#include "pipeline/sheet/warm_start.h"

namespace isoshell {

namespace {

RelaxedSeeds from_previous(const PreparedSurface& prepared, Context& context) {
  return relax_from_previous(prepared.sheet, *prepared.previous, prepared.target.vertices,
                             relax_options(prepared.options), prepared.options.tolerance.has_value(), context);
}

/// What was relaxed meanwhile by these options from this frame, once; no seeds where there is no such.
RelaxedSeeds take_relaxed(const PreparedSurface& prepared, const LevelOptions& options, const PreviousFrame* previous) {
  RelaxedMeanwhile* const made = prepared.relaxed.get();
  if (!made || made->previous.get() != previous || !(made->options == options)) return {};
  return std::exchange(made->relaxed, {});
}

}  // namespace

LevelOptions level_options(const PreparedSurface& prepared) {
  const RemeshOptions& options = prepared.options;
  return {{prepared.target.vertices, options.seed}, relax_options(options), options.tolerance.has_value()};
}

void relax_meanwhile(PreparedSurface& prepared, Run& run) {
  const std::shared_ptr<CreaseSearch> search = prepared.creases;
  if (!search || !search->goes_on()) return;
  RelaxedMeanwhile made{level_options(prepared), prepared.previous, {}};
  try {
    made.relaxed = run.timed("relax", [&] {
      return made.previous
                 ? from_previous(prepared, run.context)
                 : relax_by_levels(prepared, made.options, run.context, [&] { return search->has_found_curves(); });
    });
  } catch (const Error& error) {  // what may not be needed at all may fail for want of room or memory
    const bool wants_room = dynamic_cast<const NoRoom*>(&error) || error.code() == ErrorCode::out_of_memory;
    if (!wants_room) throw;
  }
  if (made.relaxed.seeds.size() > 0 && !search->has_found_curves())
    prepared.relaxed = std::make_shared<RelaxedMeanwhile>(std::move(made));
}

RelaxedSeeds relaxed_by_levels(const PreparedSurface& prepared, Context& context) {
  const LevelOptions levels = level_options(prepared);
  RelaxedSeeds meanwhile = take_relaxed(prepared, levels, nullptr);
  return meanwhile.seeds.size() > 0 ? std::move(meanwhile) : relax_by_levels(prepared, levels, context);
}

RelaxedSeeds relaxed_from_previous(const PreparedSurface& prepared, Context& context) {
  RelaxedSeeds meanwhile = take_relaxed(prepared, level_options(prepared), prepared.previous.get());
  return meanwhile.seeds.size() > 0 ? std::move(meanwhile) : from_previous(prepared, context);
}

}  // namespace isoshell
