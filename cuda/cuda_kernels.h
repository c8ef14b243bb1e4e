// The kernels of the device: what it does in its own way, and why that is faster. See stages/plain_kernels.h.
//
// Stages of its own from end to end:
//   voxelize (cuda_sites.cu): triangles differ in size by orders; they are cut into pieces of like size for all
//   threads. build_shell (cuda_shell.cu): the distance transform's rows lie in shared memory. nano_index_grid
//   (cuda_nano_grid.cu): the grid is built where its voxels are. relax_on_sheet (cuda_relax_sheet.cu): three kernels a
//   pass over patches whose vertices and candidates fit a warp's
//     registers and shared memory; the body where a sheet has no such patches.
//   relax_in_shell (cuda_relax_shell.cu): two kernels a pass, none of which the host waits for.
#pragma once

#include "stages/plain_kernels.h"

namespace isoshell {

struct CudaBuildShell;
struct FindOutsideByBlocks;
struct JoinComponentsByLeaves;
struct ListSiteTrianglesByMasks;
namespace dual {
struct SplitCellsByBlocks;
}
namespace post {
struct FlipEdgesInBatches;
struct SearchPlacesInOneLaunch;
struct UndoHarmInOneLaunch;
}  // namespace post

struct CudaKernels {
  /// sample_forms.cuh: a thread tests one leaf with one triangle, once; a leaf's sites read the masks that come out.
  using ListSiteTriangles = ListSiteTrianglesByMasks;
  /// cuda_sheet.cu: the stage itself.
  using BuildShell = CudaBuildShell;
  /// sheet_flood.cuh: a block of threads floods a block of leaves, and the host looks every eighth round only.
  using FindOutside = FindOutsideByBlocks;
  /// sheet_components.cuh: joins inside every leaf in shared memory first, so that few go through global memory.
  using JoinComponents = JoinComponentsByLeaves;
  /// split_cells.cuh: a block of threads a cell; cells are few and large.
  using SplitCells = dual::SplitCellsByBlocks;
  /// post_kernels.cuh: three rounds between two looks of the host; one that finds nothing changes nothing.
  using FlipEdges = post::FlipEdgesInBatches;
  /// post_kernels.cuh: all rounds in one cooperative launch, none of which the host waits for.
  using UndoHarm = post::UndoHarmInOneLaunch;
  /// post_kernels.cuh: the same, and a warp a vertex: a lane tries each place.
  using SearchPlaces = post::SearchPlacesInOneLaunch;

  // Plain: one thread an element, or the step's form.
  using ProjectVertices = PlainKernels::ProjectVertices;
  using LabelSheet = PlainKernels::LabelSheet;
  using Walks = PlainKernels::Walks;
  using PassWork = PlainKernels::PassWork;
  using StepWork = PlainKernels::StepWork;

  // Of stages that are its own from end to end.
  using LeafPasses = WholeStage;
};

}  // namespace isoshell
