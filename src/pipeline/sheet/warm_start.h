// A frame that begins with the vertices of the frame before.
#pragma once

#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

/// Decides whether a run begins with the frame before, once it is known how many vertices it is to have: sets
/// p.previous. Result: why it does not where there is one.
std::string choose_beginning(PreparedSurface& p);

/// Seeds where the vertices of the frame before are now, with their numbers, and more in the middles of the longest
/// edges where more are wanted; relaxed without levels, and in few passes: every pass takes vertices from where they
/// were, and most of what a frame needs is there already. The passes and the tolerance of `options` stand when they are
/// less, or asked for.
RelaxedSeeds relax_from_previous(const Sheet& sheet, const PreviousFrame& previous, int64_t wanted,
                                 const RelaxOptions& options, bool tolerance_requested, Context& context);

/// Much smoothing would wear down tips over many frames.
OptimizeOptions for_warm_frame(OptimizeOptions options);

}  // namespace isoshell
