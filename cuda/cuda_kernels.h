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

#include <type_traits>

#include "stages/plain_kernels.h"

namespace isoshell {

struct CudaBuildShell;
struct CudaDilate;
struct FindOutsideByBlocks;
struct JoinComponentsByLeaves;
struct ListSiteTrianglesByMasks;
struct ProjectByLeaves;
namespace dual {
struct SplitCellsByBlocks;
}
namespace optimize {
struct FlipEdgesInBatches;
struct MeshPassesInOneLaunch;
struct SearchPositionsInOneLaunch;
class StepsByLanes;
struct UndoHarmInOneLaunch;
}  // namespace optimize

// Steps with a cooperative kernel; see CudaKernels::CooperativeSteps.
struct SampleSites;
struct SortLeafTriangles;
namespace attach_seeds {
struct AttachSeed;
}
namespace component_steps {
struct JoinAcrossLeaves;
struct JoinInsideLeaf;
}  // namespace component_steps
namespace distance_steps {
struct SumPlaces;
}
namespace dual {
struct DecideDisconnectedPiece;
struct FoundCell;
struct JoinDisconnectedPiece;
}  // namespace dual
namespace flood {
struct FindNeighbours;
struct ListReached;
struct Spread;
}  // namespace flood
namespace label {
template <int kCapacity>
struct LabelBlock;
}
namespace level_set_steps {
struct BlockSteps;
struct ListCorners;
struct MeasureLeaf;
}  // namespace level_set_steps
namespace sample_cooperative {
struct CountMet;
struct FillMet;
}  // namespace sample_cooperative
namespace sheet_steps {
struct CountFaces;
struct DescribeCorners;
struct FindAdditions;
struct ListFaces;
struct MarkCorners;
struct SmoothCorners;
struct WantCornerLeaves;
}  // namespace sheet_steps
namespace topology_steps {
struct AddAreas;
}

template <class... Steps>
struct StepList {
  template <class Step>
  static constexpr bool has = (std::is_same_v<Step, Steps> || ...);
};

struct CudaKernels {
  /// sample_cooperative.cuh: a thread tests one leaf with one triangle, once; a leaf's sites read the masks that come
  /// out.
  using ListSiteTriangles = ListSiteTrianglesByMasks;
  /// cuda_sheet.cu: the stage itself.
  using BuildShell = CudaBuildShell;
  /// cuda_shell.cu: the voxels of a shell, without closest sites.
  using Dilate = CudaDilate;
  /// sheet_flood.cuh: a block of threads floods a block of leaves, and the host looks every eighth round only.
  using FindOutside = FindOutsideByBlocks;
  /// project_leaves.cuh: a block of threads a leaf of corners, which lists the triangles near it once.
  using ProjectVertices = ProjectByLeaves;
  /// sheet_components.cuh: joins inside every leaf in shared memory first, so that few go through global memory.
  using JoinComponents = JoinComponentsByLeaves;
  /// split_cells.cuh: a block of threads a cell; cells are few and large.
  using SplitCells = dual::SplitCellsByBlocks;
  /// mesh_passes_kernel.cuh: all passes in one cooperative launch.
  using MeshPasses = optimize::MeshPassesInOneLaunch;
  /// optimize_kernels.cuh: three rounds between two looks of the host; one that finds nothing changes nothing.
  using FlipEdges = optimize::FlipEdgesInBatches;
  /// optimize_kernels.cuh: all rounds in one cooperative launch, none of which the host waits for.
  using UndoHarm = optimize::UndoHarmInOneLaunch;
  /// optimize_kernels.cuh: the same, and a warp a vertex: a lane tries each place.
  using SearchPositions = optimize::SearchPositionsInOneLaunch;
  /// steps_by_lanes.cuh: smoothing and fit of small meshes by eight lanes a vertex, one a triangle around it; samples
  /// of one triangle are added up within a warp.
  using StepWork = optimize::StepsByLanes;

  // Plain: one thread an element, or the step's cooperative kernel.
  using SortKeys = PlainKernels::SortKeys;
  using ListTrianglesAround = PlainKernels::ListTrianglesAround;
  using LabelSheet = PlainKernels::LabelSheet;
  using Walks = PlainKernels::Walks;
  using PassWork = PlainKernels::PassWork;

  // Of stages that are its own from end to end.
  using LeafPasses = WholeStage;

  /// Steps whose elements are too large for one thread, or lie so that neighbouring threads would read far apart.
  /// CooperativeKernel (cooperative_kernel.cuh) says how several threads share an element of each.
  using CooperativeSteps = StepList<
      // attach_cooperative.cuh: a warp a seed, a lane a row of the grid's cells.
      attach_seeds::AttachSeed,
      // distance_cooperative.cuh: a block a chunk of places, whose distances one thread then adds in order.
      distance_steps::SumPlaces,
      // flood_cooperative.cuh: a warp a leaf; what it reads of its 26 neighbours lies in shared memory.
      flood::FindNeighbours, flood::ListReached, flood::Spread,
      // label_cooperative.cuh: a warp a block of vertices, which gathers the block's candidates together.
      label::LabelBlock<256>,
      // level_set_cooperative.cuh: a block of threads a leaf, a warp 32 voxels; a warp a leaf, a lane a triangle.
      level_set_steps::MeasureLeaf, level_set_steps::BlockSteps, level_set_steps::ListCorners,
      // sample_cooperative.cuh: a warp a leaf, a lane a site.
      SortLeafTriangles, SampleSites, sample_cooperative::CountMet, sample_cooperative::FillMet,
      // sheet_components.cuh: a warp a leaf, a lane a vertex.
      component_steps::JoinInsideLeaf, component_steps::JoinAcrossLeaves,
      // sheet_cooperative.cuh: a warp a leaf; the voxels around it lie in shared memory.
      sheet_steps::FindAdditions, sheet_steps::WantCornerLeaves, sheet_steps::MarkCorners, sheet_steps::DescribeCorners,
      sheet_steps::CountFaces, sheet_steps::ListFaces, sheet_steps::SmoothCorners,
      // pieces_cooperative.cuh: a warp a disconnected piece, a lane a vertex of it.
      dual::DecideDisconnectedPiece, dual::JoinDisconnectedPiece, dual::FoundCell,
      // surface_cooperative.cuh: a block a run of faces, whose areas one thread then adds in order.
      topology_steps::AddAreas>;
};

}  // namespace isoshell
