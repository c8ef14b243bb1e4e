// The sheet's relaxation on a device while the host looks for creases: a run without any need not wait for the search.
#pragma once

#include "pipeline/grid/run_log.h"
#include "pipeline/sheet/hierarchy.h"

namespace isoshell {

/// How a run relaxes its sheet, by levels.
LevelOptions level_options(const PreparedSurface& prepared);

/// What a run that finds no creases goes on from.
struct RelaxedMeanwhile {
  LevelOptions options;
  std::shared_ptr<const PreviousFrame> previous;  ///< that it began with; null where it began by levels
  RelaxedSeeds relaxed;
};

/// Sets prepared.relaxed, where a search for creases goes on that has found none when the sheet is relaxed.
void relax_meanwhile(PreparedSurface& prepared, Run& run);

/// Takes what was relaxed meanwhile, if it began so; else relaxes by levels.
RelaxedSeeds relaxed_by_levels(const PreparedSurface& prepared, Context& context);
/// The same from prepared.previous.
RelaxedSeeds relaxed_from_previous(const PreparedSurface& prepared, Context& context);

}  // namespace isoshell
