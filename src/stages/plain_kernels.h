// The kernels of the stage bodies that a backend may do in its own way, and what each computes. This set holds their
// definitions: one thread an element, written once over an executor. Every other set gives the same results.
//
// A body asks for a kernel by Exec::Kernels::Name. The set is a type, so it is part of the executor's type and of every
// body's: what a source file includes cannot change which kernel a body gets. Kernels are only declared here. A source
// file that instantiates a body without the header of one of its kernels does not compile. There are no defaults: a new
// kernel is listed in every set.
#pragma once

namespace isoshell {

struct PlainBuildShell;
struct PlainDilate;
struct PlainFindOutside;
struct PlainLabelSheet;
struct PlainListSiteTriangles;
struct PlainProjectVertices;
struct PlainSortKeys;
struct PlainWalks;
namespace shell_steps {
struct PlainLeafPasses;
}
namespace sheet_steps {
struct PlainJoinComponents;
struct PlainListTrianglesAround;
}  // namespace sheet_steps
namespace relax_sheet {
class PlainPassWork;
}
namespace dual {
struct PlainSplitCells;
}
namespace optimize {
struct PlainFlipEdges;
struct PlainMeshPasses;
struct PlainSearchPositions;
struct PlainStepWork;
struct PlainUndoHarm;
}  // namespace optimize

struct PlainKernels {
  // measure_topology, snap_surface
  using SortKeys = PlainSortKeys;  ///< by two numbers of vertices: soup_keys.h

  // sample_sites
  using ListSiteTriangles = PlainListSiteTriangles;  ///< the triangles that meet each site: samples_body.h

  // build_shell
  using LeafPasses = shell_steps::PlainLeafPasses;  ///< voxels within reach, closest sites of a leaf: shell_body.h

  // build_level_set
  using Dilate = PlainDilate;  ///< a set of voxels by a ball: sparse/reach.h

  // build_sheet, build_proxy
  using BuildShell = PlainBuildShell;                       ///< the shell that closing needs: shell_body.h
  using FindOutside = PlainFindOutside;                     ///< flood from the border: sheet_flood_body.h
  using JoinComponents = sheet_steps::PlainJoinComponents;  ///< of the boundary: sheet_components_body.h
  using ProjectVertices = PlainProjectVertices;             ///< onto the nearest triangles: sheet_project_body.h
  using ListTrianglesAround = sheet_steps::PlainListTrianglesAround;  ///< each vertex: sheet_body.h

  // relax_on_sheet, triangulate_dual, optimize_mesh
  using LabelSheet = PlainLabelSheet;  ///< nearest seed of every vertex: label_body.h
  using Walks = PlainWalks;            ///< along the sheet to what is nearest: sheet_walk.h

  // relax_on_sheet
  using PassWork = relax_sheet::PlainPassWork;  ///< labels, cells and energy of a pass: relax_sheet_body.h

  // triangulate_dual
  using SplitCells = dual::PlainSplitCells;  ///< dual_split_body.h

  // optimize_mesh
  using StepWork = optimize::PlainStepWork;                ///< smoothing and fit: optimize_steps.h
  using MeshPasses = optimize::PlainMeshPasses;            ///< relaxation on the mesh: optimize_mesh_passes.h
  using FlipEdges = optimize::PlainFlipEdges;              ///< in independent sets: optimize_flips.h
  using UndoHarm = optimize::PlainUndoHarm;                ///< of a step, to a fixed point: optimize_guard.h
  using SearchPositions = optimize::PlainSearchPositions;  ///< for poor vertices: optimize_search.h
};

/// Stands in a set for a kernel that no body asks for, since the backend does the whole stage in its own way.
struct WholeStage;

}  // namespace isoshell
