// The dual mesh of relaxed seeds, with as many vertices as there are seeds.
#pragma once

#include "isoshell/remesh.h"

namespace isoshell {

/// Gives seeds their mesh: the dual of their cells, whose repair may put seeds in; as many are taken out again that
/// `count.target` are left. Where it took many, the seeds relax again before. Fills report.dual: where cells failed,
/// none are taken out. The seeds stay in `made` when a stage throws.
void make_dual_of_seeds(const SurfaceMesh& surface, const CollapseOptions& count, SeededMesh& made,
                        RemeshReport& report, Context& context);

}  // namespace isoshell
