// The sheet's relaxation on a device while the host looks for creases: a run without any need not wait for the search.
#pragma once

#include "pipeline/sheet/hierarchy.h"

namespace isoshell {

/// How the options of a run relax the sheet, by levels.
LevelOptions level_options(const Prepared& prepared, const RemeshOptions& options);
/// How they relax whatever is relaxed.
RelaxOptions relax_options(const RemeshOptions& options);

/// What a run that finds no creases goes on from.
struct RelaxedMeanwhile {
  LevelOptions options;
  std::shared_ptr<const PreviousFrame> previous;  ///< that it began with; null where it began by levels
  RelaxedSeeds relaxed;
};

/// Sets prepared.relaxed, where a search for creases goes on that has found none when the sheet is relaxed.
void relax_meanwhile(const RemeshOptions& options, Prepared& prepared, RemeshReport& report, Context& context);

/// Takes what was relaxed meanwhile, if it is what these options make; else relaxes by levels.
RelaxedSeeds relaxed_by_levels(const Prepared& prepared, const RemeshOptions& options, Context& context);
/// The same from the frame before, which options name.
RelaxedSeeds relaxed_from_previous(const Prepared& prepared, const RemeshOptions& options, Context& context);

}  // namespace isoshell
