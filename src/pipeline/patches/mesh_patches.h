// The mesh of a surface in patches, from their relaxed seeds.
#pragma once

#include <string>
#include <vector>

#include "pipeline/patches/patches.h"

namespace isoshell {

/// The patches of a mesh that are wrong, and what is.
struct WrongPatches {
  std::vector<char> is_wrong;
  std::string what;  ///< empty: nothing
};

/// Dual and optimisation of the relaxed seeds of `cut`, in place. Where triangles intersect, or cells are no disks,
/// patches in a plane are triangulated, and between regions those as small as their edges. Result: the patches that are
/// wrong in the end: those that fail have no triangles.
WrongPatches mesh_patches(const PreparedSurface& p, const CutSurface& cut, SeededMesh& made,
                          const PatchOptions& options, RemeshReport& report, Context& context);

}  // namespace isoshell
