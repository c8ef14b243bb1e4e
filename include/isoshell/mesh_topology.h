// What kind of complex a triangle mesh is: the last check of every run.
#pragma once

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Counts by indices alone; positions play no part. Triangles that repeat a corner are counted and then ignored.
struct MeshTopology {
  int64_t components = 0;            ///< of referenced vertices, connected through edges
  int64_t genus = -1;                ///< sum over the components; -1 unless manifold
  int64_t euler = 0;                 ///< V - E + F of the referenced vertices
  int64_t boundary_loops = 0;        ///< connected sets of edges with one face
  int64_t boundary_edges = 0;        ///< with one face
  int64_t nonmanifold_edges = 0;     ///< with more than two faces, or with two that traverse it in the same direction
  int64_t nonmanifold_vertices = 0;  ///< whose faces are not one fan
  int64_t unreferenced_vertices = 0;
  int64_t degenerate_triangles = 0;  ///< with a corner repeated
  int64_t repeated_triangles = 0;    ///< with the corners of another one, in any order, beyond the first
  bool closed = false;               ///< there are triangles, and every edge has two or more
  bool manifold =
      false;  ///< no edge, vertex or triangle of the kinds that spoil a 2-manifold, with or without boundary

  /// A closed, consistently oriented 2-manifold that uses every vertex.
  bool is_closed_manifold() const { return closed && manifold && unreferenced_vertices == 0; }
  /// The same with so many borders, and no others.
  bool is_manifold_with(int64_t loops) const {
    return loops == 0 ? is_closed_manifold() : manifold && unreferenced_vertices == 0 && boundary_loops == loops;
  }
};

/// Cost: linear in triangles for bounded valence; about 50 bytes a triangle.
/// Throws: usage when an index is not below vertex_count, or when there are more than 2^32 / 3 triangles.
MeshTopology check_mesh(View<const TriangleIndices> triangles, int64_t vertex_count);
MeshTopology check_mesh(const TriangleMesh& mesh);

}  // namespace isoshell
