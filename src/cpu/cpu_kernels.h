// The kernels of the CPU: what it does in its own way, and why that is faster. See stages/plain_kernels.h. Beside these
// it has one stage of its own: cut_false_handles (cpu_cut_handles.cpp), which is sequential by nature and which CUDA
// takes over.
#pragma once

#include "stages/plain_kernels.h"

namespace isoshell {

class CpuPassSimd;
class CpuStepSimd;
class LabelSimd;
class WalksAhead;
struct CpuBuildShell;
struct CpuListSiteTriangles;
struct CpuListTrianglesAround;
struct CpuMeshPasses;
struct CpuSortKeys;
struct LeafSimd;
struct ProjectLanes;

struct CpuKernels {
  /// sort_keys.h: buckets by the first vertex, which hold a few keys each.
  using SortKeys = CpuSortKeys;
  /// leaf_simd.h: separable passes over rows of eight voxels, a row a vector, instead of all sites for each voxel.
  using LeafPasses = LeafSimd;
  /// cpu_backend.h: the stage itself, which is instantiated once.
  using BuildShell = CpuBuildShell;
  /// list_site_triangles.h: where a triangle meets a leaf is found once, not for counting and again for listing.
  using ListSiteTriangles = CpuListSiteTriangles;
  /// list_triangles_around.h: no atomics where a thread runs alone, and lists that need no sorting then.
  using ListTrianglesAround = CpuListTrianglesAround;
  /// project_simd.h: runs of vertices share the triangles that they meet, which are taken in lanes.
  using ProjectVertices = ProjectLanes;
  /// label_simd.h: all vertices of a leaf are compared with one seed after the other, in lanes.
  using LabelSheet = LabelSimd;
  /// walk_ahead.h: memory is asked for some walks ahead, and the triangles where walks end are taken in lanes.
  using Walks = WalksAhead;
  /// pass_simd.h: bounds and last labels are kept from pass to pass; triangles are measured and cells cut in lanes.
  using PassWork = CpuPassSimd;
  /// optimize_simd.h: the triangles around each vertex are listed once, samples are sorted by triangle, sums go in
  /// lanes.
  using StepWork = CpuStepSimd;
  /// mesh_passes_simd.h: triangles are measured in lanes; the few edges that may flip are listed once.
  using MeshPasses = CpuMeshPasses;

  // Plain: they take little of a run's time, or leave nothing to share between elements.
  using Dilate = PlainKernels::Dilate;
  using FindOutside = PlainKernels::FindOutside;
  using JoinComponents = PlainKernels::JoinComponents;
  using SplitCells = PlainKernels::SplitCells;
  using FlipEdges = PlainKernels::FlipEdges;
  using UndoHarm = PlainKernels::UndoHarm;
  using SearchPositions = PlainKernels::SearchPositions;
};

}  // namespace isoshell
