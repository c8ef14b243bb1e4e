// The dual mesh of relaxed seeds, with as many vertices as there are seeds.
#pragma once

#include "pipeline/grid/run_log.h"

namespace isoshell {

/// Gives seeds their mesh: the dual of their cells, whose repair may put seeds in; as many are taken out again that
/// `count.target` are left. Where it took many, the seeds relax again before. Where cells failed, none are taken out.
/// The seeds stay in `made` when a stage throws.
DualReport make_dual_of_seeds(const SurfaceMesh& surface, const CollapseOptions& count, SeededMesh& made, Run& run);

}  // namespace isoshell
