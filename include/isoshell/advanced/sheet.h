// The sheet: the closed 2-manifold that bounds the solid inside the shell, laid onto the surface.
#pragma once

#include "isoshell/advanced/surface_mesh.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// Topology of the sheet, which is a closed orientable 2-manifold by construction.
struct SheetTopology {
  int64_t components = 0;
  int64_t genus = 0;               ///< sum over the components
  int64_t dropped_components = 0;  ///< smaller than the area limit
  int64_t bridged_vertices = 0;    ///< farther than two voxels from the surface
  int64_t cut_handles = 0;         ///< false ones, where near parts of the surface share voxels
};

/// The mesh, and the lattice that it comes from. Result: vertex i is lattice corner i of `corners` in canonical order,
/// and a block has the vertices of a leaf. Triangles come from the boundary faces of the solid, two a face, in the
/// order of (solid voxel, face), oriented outward. Positions are on the input surface, or on a smooth bridge over a
/// gap.
struct Sheet : SurfaceMesh {
  LatticeFrame frame;
  VoxelSet corners;
  Buffer<uint32_t> source_triangle;  ///< of the surface, nearest to the vertex; kNone on a bridge
  SheetTopology topology;
};

}  // namespace isoshell
