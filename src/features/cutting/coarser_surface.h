// A cut surface with fewer triangles, for seeds that only look for their places.
#pragma once

#include "features/cutting/cut_surface.h"
#include "features/cutting/free_seeds.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// On a lattice with voxels twice as large. Patches, places and curves keep their numbers.
struct CoarserSurface {
  CutSurface cut;                  ///< of no fine mesh
  std::vector<uint32_t> in_finer;  ///< per vertex that of the finer surface at the same point
};

/// Takes vertices into their neighbours, on curves along these, until edges are about a third of the edge length aimed
/// at, which is that of the seeds of so many levels coarser: its curves have the seeds of that level as their own.
/// `seeds`: how many free ones each patch is to have; a patch with few vertices for them keeps these, and what would
/// fold over stays. Result: the same for any number of threads. Cost: O(surface). Throws: usage as make_surface_mesh.
CoarserSurface coarser_surface(const CutSurface& finer, const FreeSeeds::Counts& seeds, int levels, Context& context);

/// Makes a mesh on the coarser surface, in host memory, one on the finer.
void bring_to_finer(const CoarserSurface& coarser, SeededMesh& made);

}  // namespace isoshell
