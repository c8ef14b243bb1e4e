// The mesh of a surface in patches, made in rounds: patches that are good stay, and the others are made again.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pipeline/patches/patches.h"

namespace isoshell {

/// Makes the mesh of the relaxed seeds of `cut`. Where triangles intersect, or cells are no disks, patches in a
/// plane are triangulated there; around others curves get more seeds first, then the creases there go, and only the
/// patches beside these curves are made again: until that has taken twice the surface, or the whole of it without
/// leaving less wrong where the curves can be laid on the sheet instead. A frame that follows another loses no crease:
/// it ends there, to begin cold. In the end `cut` is the surface that the mesh is on. Result: why there is no mesh;
/// empty where there is one, which may have another number of vertices.
std::string mesh_in_rounds(const PreparedSurface& p, std::shared_ptr<const CutSurface>& cut, SeededMesh& made,
                           const PatchOptions& options, RemeshReport& report, Context& context);

/// The patches of a mesh that are wrong, and what is.
struct WrongPatches {
  std::vector<char> is_wrong;
  std::string what;  ///< empty: nothing
};

/// The same between regions, whose curves all stay, without rounds: patches in a plane, and those as small as their
/// edges, are triangulated where something is wrong, and others stay wrong.
WrongPatches mesh_once(const PreparedSurface& p, const CutSurface& cut, SeededMesh& made, const PatchOptions& options,
                       RemeshReport& report, Context& context);

}  // namespace isoshell
