// The mesh of a surface in patches, from their relaxed seeds.
#pragma once

#include <string>
#include <vector>

#include "pipeline/patches/patches.h"

namespace isoshell {

/// Patches as they were optimised, in host memory.
struct OptimizedPatches {
  SeedSet seeds;  ///< the vertices before that, as many as are asked for
  SeededMesh made;
  std::vector<char> is_optimized;  ///< per patch
};

/// Where a mesh of relaxed seeds cannot be the run's.
struct PatchFaults {
  std::vector<uint32_t> vertices;  ///< of the mesh; ascending
  std::string what;                ///< empty: there are none
  DualReport dual = {};
  OptimizeReport optimize = {};
  OptimizedPatches optimized = {};  ///< where there are some faults
};

/// The mesh of relaxed seeds with the cells that its vertices are from.
struct MeshWithCells {
  SeededMesh made;
  std::vector<TriangleIndices> dual;  ///< of the vertices, as their cells meet: before edges were flipped
  std::vector<uint32_t> cell;         ///< per vertex of the surface the vertex whose cell it is in
  std::vector<char> is_optimized;     ///< per patch: one with cells that are no disks is not
  PatchFaults faults;
};

/// Dual and optimisation of the relaxed seeds of `cut`, in place; patches with cells that are no disks are not
/// optimised, and those with faults that lie in a plane are triangulated there. Result: the vertices whose cells are
/// none, of triangles that intersect and must not, and of regions that are inside out.
PatchFaults mesh_patches(const PreparedSurface& p, const CutSurface& cut, SeededMesh& made, const PatchOptions& options,
                         Run& run);

/// The mesh of the seeds that were optimised, with their cells and with all vertices that the dual's repair puts in.
/// Patches in which it puts in none are taken as they were optimised, and others are optimised but for walls of
/// regions. In host memory.
MeshWithCells mesh_with_cells(const PreparedSurface& p, const CutSurface& cut, const OptimizedPatches& optimized,
                              const PatchOptions& options, OptimizeReport& sum, Run& run);

}  // namespace isoshell
