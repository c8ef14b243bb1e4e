// Seeds from coarse to fine: what makes almost every vertex of the result regular.
#pragma once

#include "isoshell/remesh.h"

namespace isoshell {

/// Relaxes `count` seeds on the sheet. Few seeds are relaxed first and triangulated; each edge's middle becomes a seed
/// of the next level, where it starts with six neighbours; at most three levels, four times the seeds on each. A level
/// whose dual needs more than 6 % of repair is too coarse for the shape and is left out. The report is that of the
/// finest level. Coarse levels relax on coarse proxies of the sites on coarser lattices, whose voxels are as large
/// beside their cells as those of the sheet are beside the finest level's. `options.max_passes` bounds the finest
/// level; its tolerance is that of every level when it was asked for, else levels have their own.
RelaxedSeeds relax_by_levels(const Prepared& prepared, const SeedOptions& seeds, const RelaxOptions& options,
                             bool tolerance_asked, Context& context);

}  // namespace isoshell
