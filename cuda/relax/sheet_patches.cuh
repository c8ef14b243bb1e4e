// The sheet cut into patches, parts of a block of about the same size, each with all that a pass reads of it: copies of
// its vertices and of those around it that its triangles use, triangles by their places among these, bounds, and the
// moments of the whole and of each of its own vertices. A triangle is its smallest vertex's own. These patches have
// nothing to do with those that a surface may be cut into (SurfaceMesh::patch), but that each is in one of them.
#pragma once

#include "cuda/relax/label_sums.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "isoshell/advanced/seed_set.h"
#include "isoshell/advanced/surface_mesh.h"
#include "stages/relax/relax_sheet_body.h"
#include "voxel/cell_sum.h"

namespace isoshell::cuda_relax {

constexpr int kMaxPatchVertices = 1024;  ///< of its own and around them
constexpr int kMaxLocal = 1 << 13;       ///< bound of a local coordinate: the budget of voxel/cell_sum.h

/// A vertex relative to the middle of the patch's block, q8.
struct alignas(8) PatchVertex {
  int16_t x, y, z, unused;
  __device__ Local local() const { return {x, y, z}; }
};

/// Places of the corners among the patch's vertices, 10 bits each, which of them it belongs to, and the doubled area.
struct alignas(8) PackedTriangle {
  uint32_t corners, area2;
  __device__ int corner(int i) const { return int(corners >> (10 * i)) & 1023; }
  __device__ int owner() const { return int(corners >> 30); }
};

/// Bounds of the vertices, and the normals', packed.
struct alignas(16) PatchBounds {
  PointQ8 origin;
  uint32_t normal_lo;
  int16_t lo[3], hi[3];  ///< from the origin
  uint32_t normal_hi;
};

struct alignas(16) Patch {
  PatchBounds bounds;
  int64_t vertex_first, triangle_first, owned_first;
  uint16_t own, vertices, triangles;  ///< a patch's own vertices come first
  uint16_t has_fixed;                 ///< 1: labels of some vertices are prescribed
  PieceSum total;                     ///< of all triangles
  uint32_t surface_patch;             ///< that it is in; kNone where the surface is not cut
};

struct PatchesView {
  const Patch* patch;
  const PatchVertex* vertex;
  const uint32_t* normal;  ///< packed, per vertex
  const PackedTriangle* triangle;
  const PieceBytes* owned;  ///< moments of the own vertices' triangles, 32 vertices by 32 lanes
  const uint32_t* fixed;    ///< per vertex the label that is prescribed, or kNone; read where a patch has some
  int64_t count;
};

struct SheetPatches {
  Buffer<Patch> patch;
  Buffer<PatchVertex> vertex;
  Buffer<uint32_t> normal;
  Buffer<PackedTriangle> triangle;
  Buffer<PieceBytes> owned;
  Buffer<uint32_t> fixed;  ///< empty without fixed seeds
  bool fits = true;        ///< false: the sheet breaks a limit of patches; relax with the plain body

  PatchesView view() const {
    return {patch.data(), vertex.data(), normal.data(), triangle.data(), owned.data(), fixed.data(), patch.size()};
  }
};

/// Makes the patches of a sheet in device memory, with at most so many vertices of their own.
SheetPatches make_sheet_patches(CudaExecutor& exec, const SurfaceMesh& surface, const FixedSeeds& fixed, int max_own);

}  // namespace isoshell::cuda_relax
