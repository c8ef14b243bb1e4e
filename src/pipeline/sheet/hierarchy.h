// Seeds from coarse to fine: what makes almost every vertex of the result regular.
#pragma once

#include <functional>

#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

struct LevelOptions {
  SeedOptions seeds;
  RelaxOptions relax;                ///< max_passes bounds the finest level
  bool tolerance_requested = false;  ///< then it is that of every level, else levels have their own

  bool operator==(const LevelOptions& o) const {
    return seeds == o.seeds && relax == o.relax && tolerance_requested == o.tolerance_requested;
  }
};

/// Relaxes `options.seeds.count` seeds on the sheet. Few seeds are relaxed first and triangulated; each edge's middle
/// becomes a seed of the next level, where it starts with six neighbours; at most three levels, four times the seeds on
/// each. A level whose dual needs more than 6 % of repair is too coarse for the shape and is left out. The report is
/// that of the finest level. Coarse levels relax on coarse proxies of the sites on coarser lattices, whose voxels are
/// as large beside their cells as those of the sheet are beside the finest level's. `is_in_vain` is asked between
/// stages; once it says so, the result has no seeds.
RelaxedSeeds relax_by_levels(
    const PreparedSurface& prepared, const LevelOptions& options, Context& context,
    const std::function<bool()>& is_in_vain = [] { return false; });

}  // namespace isoshell
