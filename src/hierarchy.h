// Seeds from coarse to fine: what makes almost every vertex of the result regular.
#pragma once

#include "isoshell/stages.h"

namespace isoshell {

/// Relaxes `count` seeds on the sheet. Few seeds are relaxed first and triangulated; each edge's middle becomes a seed of
/// the next level, where it starts with six neighbours; at most three levels, four times the seeds on each. A level
/// whose dual needs more than half a percent of repair is too coarse for the shape and is left out. The report is that
/// of the finest level.
SeedSet relax_by_levels(const Sheet& sheet, const SeedOptions& seeds, const RelaxOptions& options, RelaxReport& report,
                        Context& context);

}  // namespace isoshell
