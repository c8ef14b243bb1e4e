// The surface on the lattice: vertices snapped once, triangles in an order that does not depend on the file's.
#pragma once

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/advanced/voxel_set.h"
#include "isoshell/surface_source.h"

namespace isoshell {

template <>
constexpr bool kHasNoPadding<WorldPoint> = sizeof(WorldPoint) == 3 * sizeof(double);

/// Corners by point index.
struct TriangleIndices {
  uint32_t a, b, c;
};
ISOSHELL_HD inline bool operator==(TriangleIndices s, TriangleIndices t) {
  return s.a == t.a && s.b == t.b && s.c == t.c;
}

/// Topology of the input mesh after its vertices are welded by exact position, before snapping.
struct InputTopology {
  bool closed = false;         ///< every edge has exactly two faces
  bool oriented = false;       ///< and they traverse it in opposite directions
  int64_t components = 0;      ///< connected through shared vertices
  int64_t boundary_loops = 0;  ///< connected sets of edges with one face
  int64_t euler = 0;           ///< V - E + F of the welded mesh
  int64_t genus = -1;          ///< sum over the components; -1 unless closed and every vertex has one fan
  double area_world = 0;       ///< square world units; the sum does not depend on the order of the faces
};

/// Surface in fixed point. Result: points are the distinct snapped positions in the order of (leaf key of their voxel,
/// x, y, z); triangles start at their smallest index, keep their orientation, are unique and sorted. So two files with
/// the same faces in another order give the same surface. Triangles without area stay: they still occupy voxels.
struct LatticeSurface {
  LatticeFrame frame;
  Buffer<PointQ8> points;
  Buffer<TriangleIndices> triangles;
  Buffer<uint32_t> source_face;  ///< smallest index of the soup's triangle that became this one
  InputTopology topology;
  uint32_t first_cap = kNone;  ///< source faces from this one on close holes
};

}  // namespace isoshell
