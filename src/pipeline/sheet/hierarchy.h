// Seeds from coarse to fine: what makes almost every vertex of the result regular.
#pragma once

#include <functional>
#include <optional>

#include "isoshell/advanced/stages.h"
#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

constexpr int64_t kFewestSeeds = 64;    ///< of a level
constexpr int64_t kFewestPerPart = 12;  ///< seeds of a level; with fewer its dual is no mesh

/// What a coarse level is relaxed by.
struct CoarseLevel {
  RelaxOptions relax;  ///< of a single level
  bool tolerance_requested = false;
  bool has_random_seeds = false;  ///< no coarser level came before
};
/// What the finest level after a coarser one makes of the options of a single level: it stops at the usual tolerance,
/// unless one is requested.
RelaxOptions for_finest_level(RelaxOptions relax, bool tolerance_requested, int32_t usual_tolerance_ppb);
/// The usual one on a sheet.
int32_t finest_tolerance_ppb(const SurfaceMesh& sheet);

/// Relaxes a coarse level: on the sheet, and where edges are as long everywhere on its mesh, too. Returns its dual with
/// as many vertices as it had seeds, flipped and smoothed, so that the cells of the seeds that it is split into meet as
/// its triangles do; none when the level is too coarse for the shape.
std::optional<SeededMesh> relax_level(const SurfaceMesh& surface, const CoarseLevel& level, SeedSet seeds,
                                      Context& context);

struct LevelOptions {
  SeedOptions seeds;
  RelaxOptions relax;                ///< max_passes bounds the finest level
  bool tolerance_requested = false;  ///< then it is that of every level, else levels have their own

  bool operator==(const LevelOptions& o) const {
    return seeds == o.seeds && relax == o.relax && tolerance_requested == o.tolerance_requested;
  }
};

/// Relaxes `options.seeds.count` seeds on the sheet. Few seeds are relaxed first and triangulated; each edge's middle
/// becomes a seed of the next level, where it starts with six neighbours; levels have four times the seeds of the one
/// before, and the coarsest at most 2400, but never fewer than 64, and 12 of each part. A level whose dual needs more
/// than 6 % of repair is too coarse for the shape and is left out. The report is that of the finest level. Coarse
/// levels relax on coarse proxies of the sites on coarser lattices, whose voxels are as large beside their cells as
/// those of the sheet are beside the finest level's. `is_in_vain` is asked between stages; once it says so, the result
/// has no seeds.
RelaxedSeeds relax_by_levels(
    const PreparedSurface& prepared, const LevelOptions& options, Context& context,
    const std::function<bool()>& is_in_vain = [] { return false; });

}  // namespace isoshell
