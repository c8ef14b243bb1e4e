// Nearest points of a mesh, on the host.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/triangle_search.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Cost: 50 bytes a triangle, at most 160. A search looks at few cells where p is near to the mesh, and at
/// each block of 512 cells where it is far.
class TriangleGrid {
 public:
  using Triangles = std::vector<std::array<uint32_t, 3>>;

  /// Keeps references to both. There is at least one triangle.
  TriangleGrid(const std::vector<WorldPoint>& vertices, const Triangles& triangles);
  explicit TriangleGrid(const TriangleMesh& mesh) : TriangleGrid(mesh.vertices, mesh.triangles) {}
  TriangleGrid(const TriangleGrid&) = delete;

  /// Of the mesh, to p. Of triangles that are equally near the smallest index.
  MeshPoint nearest(WorldPoint p) const;
  /// The same among triangles whose normals are less than a right angle from `direction`, and at most so far from p;
  /// kNoTriangle where there is none.
  MeshPoint nearest_facing(WorldPoint p, WorldPoint direction, double farthest) const;
  /// The same among triangles whose normals are nearly along the line of `normal`, which has length 1: the cosine of
  /// the angle between them is so large or larger.
  MeshPoint nearest_aligned(WorldPoint p, WorldPoint normal, double least_cosine, double farthest) const;
  /// Of the triangles at most so far from p that whose normal is most nearly along the line of `normal`, of length 1.
  MeshPoint most_aligned(WorldPoint p, WorldPoint normal, double farthest) const;
  double distance_to(size_t triangle, WorldPoint p) const;
  WorldPoint at(const MeshPoint& place) const;
  bool is_facing(size_t triangle, WorldPoint direction) const;
  double distance_sq(WorldPoint p) const { return nearest(p).distance_sq; }

  /// For bodies of stages; what it names lies on the host.
  const TriangleGridView& view() const { return view_; }

 private:
  using Cell = TriangleGridView::Cell;

  void choose_cells(const WorldBox& box);
  BoxOf<Cell> cells_of(size_t triangle) const;
  template <class Visit>
  void for_each_cell_of(size_t triangle, Visit visit) const;

  std::vector<uint32_t> first_, listed_;
  std::vector<uint8_t> block_used_;
  TriangleGridView view_;
};

}  // namespace isoshell
