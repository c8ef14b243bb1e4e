// The sheet cut into patches, parts of a leaf of about the same size, each with all that a pass reads of it: copies of
// its vertices and of those around it that its triangles use, triangles by their places among these, bounds, and the
// moments of the whole.
#pragma once

#include "cuda/executor_cuda.cuh"
#include "isoshell/sheet.h"
#include "stages/relax_sheet_body.h"
#include "voxel/cell_sum.h"

namespace isoshell::cuda_relax {

constexpr int kMaxPatchVertices = 1024;  ///< of its own and around them
constexpr int kMaxLocal = 1 << 13;       ///< bound of a local coordinate: the budget of voxel/cell_sum.h

/// A vertex relative to the middle of the patch's leaf, q8.
struct alignas(8) PatchVertex {
  int16_t x, y, z, unused;
  __device__ Local local() const { return {x, y, z}; }
};

/// Places of the corners among the patch's vertices, 10 bits each, and the doubled area.
struct alignas(8) PackedTriangle {
  uint32_t corners, area2;
  __device__ int corner(int i) const { return int(corners >> (10 * i)) & 1023; }
  /// The same triangle from corner i on.
  __device__ PackedTriangle from_corner(int i) const {
    return {(corners >> (10 * i) | corners << (30 - 10 * i)) & 0x3fffffffu, area2};
  }
};

struct alignas(16) Patch {
  int64_t vertex_first, triangle_first;
  PieceSum total;  ///< of all triangles
  PointQ8 origin;
  int16_t lo[3], hi[3];  ///< of the vertices
  Normal8 normal_lo, normal_hi;
  uint16_t vertices, triangles;

  __device__ label::Bounds bounds() const {
    return {{origin.x + lo[0], origin.y + lo[1], origin.z + lo[2]},
            {origin.x + hi[0], origin.y + hi[1], origin.z + hi[2]},
            normal_lo,
            normal_hi};
  }
};

struct PatchesView {
  const Patch* patch;
  const PatchVertex* vertex;
  const uint32_t* normal;  ///< packed, per vertex
  const PackedTriangle* triangle;
  int64_t count;
};

struct SheetPatches {
  Buffer<Patch> patch;
  Buffer<PatchVertex> vertex;
  Buffer<uint32_t> normal;
  Buffer<PackedTriangle> triangle;
  bool fits = true;  ///< false: the sheet breaks a limit of patches; relax with the plain body

  PatchesView view() const { return {patch.data(), vertex.data(), normal.data(), triangle.data(), patch.size()}; }
};

/// Makes the patches of a sheet in device memory, with at most so many vertices of their own.
SheetPatches make_sheet_patches(CudaExecutor& exec, const Sheet& sheet, int max_own);

}  // namespace isoshell::cuda_relax
