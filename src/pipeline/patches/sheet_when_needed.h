// Frames of a sequence that are made of patches do without a sheet, until something fails.
#pragma once

#include <optional>

#include "pipeline/patches/patches.h"

namespace isoshell {

/// Whether a frame takes the first grid when its surface can be cut along curves there, whatever topology a sheet has
/// on it: it begins with the frame before, the options say nothing that only a sheet can answer, and the surface is one
/// that needs no walls grown and no gaps closed.
bool may_be_cut_at_once(const Plan& plan, bool has_caps);

/// Whether the own triangles of a surface can be meshed whatever topology its sheet has: it is closed and oriented, no
/// gaps are to be closed, there are vertices enough for its components and handles, no seeds are to be kept in voxels,
/// and it follows no frame: a splash would change between its triangles and the sheet, and lose edges each time.
bool may_be_on_own_triangles(const PreparedSurface& p);

/// The surface, cut along its curves on its own triangles, without sites, samples and sheet. None where it cannot be
/// cut so: of the run's log only its times stay then.
std::optional<PreparedSurface> prepare_patches_alone(LatticeSurface surface, const RemeshOptions& options,
                                                     const PatchSource& source, Run& run);

/// A prepared surface with its sheet, which is made when it is asked for first.
class SheetWhenNeeded {
 public:
  SheetWhenNeeded(const PreparedSurface& prepared, Run& run) : prepared_(prepared), run_(run) {}
  /// Grid and sheet are in its report.
  const PreparedSurface& get();

 private:
  const PreparedSurface& prepared_;
  Run& run_;
  std::optional<PreparedSurface> made_;
};

}  // namespace isoshell
