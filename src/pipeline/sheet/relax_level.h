// One level of seeds, between coarser and finer ones.
#pragma once

#include <optional>

#include "isoshell/advanced/stages.h"

namespace isoshell {

constexpr int kMaxLevels = 3;
constexpr int64_t kFewestSeeds = 64;  ///< of a level

/// What a coarse level, and the finest after a coarser one, make of the options of a single level.
RelaxOptions for_coarse_level(RelaxOptions relax, bool tolerance_requested);
RelaxOptions for_finest_level(RelaxOptions relax, bool tolerance_requested);

/// Relaxes a coarse level. Returns its dual with as many vertices as it had seeds, flipped and smoothed, so that the
/// cells of the seeds that it is split into meet as its triangles do; none when the level is too coarse for the shape.
std::optional<SeededMesh> relax_level(const SurfaceMesh& surface, const RelaxOptions& relax, SeedSet seeds,
                                      Context& context);

}  // namespace isoshell
