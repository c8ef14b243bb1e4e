// A valid mesh of a cut surface with as many vertices as asked for.
#pragma once

#include <optional>

#include "features/walls/wall_mesh.h"
#include "pipeline/patches/new_crossings.h"
#include "pipeline/patches/patches.h"

namespace isoshell {

/// Tells whether a mesh of a cut surface may be a result.
class JoinedCheck {
 public:
  JoinedCheck(const PreparedSurface& p, const CutSurface& cut, Context& context)
      : cut_(cut), crossings_(p, cut, context) {}

  /// Triangles intersect where those of the input do, if anywhere, and no region is inside out.
  bool is_valid(const JoinedPatches& joined, OptimizeReport& report);

  NewCrossings& crossings() { return crossings_; }

 private:
  const CutSurface& cut_;
  NewCrossings crossings_;
};

/// Triangles that intersect are collapsed unless the result may have those of its input, then other edges are; what is
/// not settled is evened out, vertices off curves are optimised where no triangles intersect then, and angles beside
/// curves are widened. None where that is not valid. `sum`: what the optimisation did is added. Cost: as
/// collapse_crossings, coarsen, even_out, optimize_mesh and widen.
std::optional<JoinedPatches> simplify_patches(WallMesh mesh, const PatchOptions& options, JoinedCheck& check,
                                              OptimizeReport& sum, Run& run);

}  // namespace isoshell
