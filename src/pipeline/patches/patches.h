// A run whose result keeps the input's creases or borders: on the input's own triangles, cut along its curves into
// patches.
#pragma once

#include <optional>

#include "features/angles/patch_mesh.h"
#include "pipeline/grid/prepared_surface.h"
#include "pipeline/grid/run_log.h"

namespace isoshell {

/// What a surface comes from.
struct PatchSource {
  const TriangleSoup* soup = nullptr;                      ///< null: not known, as in a run that resumes
  std::vector<std::array<WorldPoint, 2>> interfaces = {};  ///< edges where parts met, which are curves beside creases
};

/// Finds the creases and borders that the options ask for, and the seams of the attributes of `source`, and cuts the
/// surface along them. Leaves p.cut empty where there are none, and says in p.report why where there are some that
/// cannot be kept. Seams are found again by the positions of their ends: what repair left as it was, and no union cut,
/// has them, and so are interfaces.
void cut_into_patches(const PatchSource& source, PreparedSurface& p, Run& run);

/// Whether the surface was cut there, and not the sheet.
bool is_on_own_triangles(const PreparedSurface& p);

struct PatchOptions {
  SeedOptions seeds;  ///< the count is that of the result's vertices: a place of a curve counts once
  RelaxOptions relax;
  bool tolerance_requested = false;  ///< coarse levels have it, too
  OptimizeOptions optimize;
  std::shared_ptr<const PreviousFrame> previous = nullptr;  ///< that seeds begin with
};

/// How the patches are put together.
inline JoinOptions join_options(const PatchOptions& options) {
  return {options.seeds.count, options.previous != nullptr};
}

/// Fixes seeds on the curves, one for each patch there, and relaxes the others between them: coarse to fine, or from
/// where the vertices of the frame before are.
RelaxedSeeds relax_in_patches(const CutSurface& cut, const PatchOptions& options, Context& context);

/// The mesh of the patches, joined along their curves; its vertices are as many as seeds were relaxed, each place of a
/// curve counted once, where that is possible. Where triangles intersect, cells are simplified from the fine
/// triangles instead. None where that fails, too: these go on intersecting, or patches touch along edges that are on no
/// curve: report.features says so. With borders that are kept triangles may intersect where the input's do.
std::optional<TriangleMesh> triangulate_patches(const PreparedSurface& p, SeededMesh& made, PatchOptions in_patches,
                                                RemeshReport& report, Run& run);

}  // namespace isoshell
