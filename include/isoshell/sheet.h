// The sheet: the closed 2-manifold that bounds the solid inside the shell, laid onto the surface.
#pragma once

#include "isoshell/lattice_surface.h"
#include "isoshell/voxel_set.h"

namespace isoshell {

/// Topology of the sheet, which is a closed orientable 2-manifold by construction.
struct SheetTopology {
  int64_t components = 0;
  int64_t genus = 0;               ///< sum over the components
  int64_t dropped_components = 0;  ///< smaller than the area limit
  int64_t bridged_vertices = 0;    ///< farther than two voxels from the surface
  int64_t cut_handles = 0;         ///< false ones, where near parts of the surface share voxels
};

/// Edge lengths to aim at, where they vary. Only ratios count: the number of seeds decides the rest.
struct EdgeLengths {
  Buffer<uint32_t> at;  ///< per sheet vertex; empty: the same everywhere
  uint32_t least = 0, largest = 0;
};

/// Result: vertex i is lattice corner i of `corners` in canonical order. Triangles come from the boundary faces of the
/// solid, two a face, in the order of (solid voxel, face), oriented outward.
struct Sheet {
  LatticeFrame frame;
  VoxelSet corners;
  Buffer<PointQ8> position;          ///< on the input surface, or a smooth bridge over a gap
  Buffer<Normal8> normal;            ///< outward, per vertex
  Buffer<uint32_t> source_triangle;  ///< of the surface, nearest to the vertex; kNone on a bridge
  Buffer<TriangleIndices> triangles;
  Buffer<int64_t> vertex_first;       ///< vertex_count + 1 offsets into vertex_triangles
  Buffer<uint32_t> vertex_triangles;  ///< ascending per vertex
  Buffer<PointQ8> missed;             ///< points of a closed surface that are 1/2 to 4 voxels off the sheet
  Buffer<uint32_t> missed_vertex;     ///< the vertex nearest to each
  SheetTopology topology;
  EdgeLengths lengths;  ///< empty as built; see set_edge_lengths

  int64_t vertex_count() const { return position.size(); }
};

}  // namespace isoshell
