// Nearest points of a mesh, by a grid of cells that list the triangles whose boxes meet them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// A point of a mesh: a + b_part (b - a) + c_part (c - a) of a triangle's corners a, b and c.
struct MeshPoint {
  static constexpr uint32_t kNoTriangle = 0xffffffff;
  double distance_sq = std::numeric_limits<double>::infinity();
  double b_part = 0, c_part = 0;
  uint32_t triangle = kNoTriangle;
};

/// In the plane where p lies over the triangle, on the edges elsewhere. Without a triangle's number.
MeshPoint nearest_of_triangle(WorldPoint p, WorldPoint a, WorldPoint b, WorldPoint c);

class TriangleGrid {
 public:
  using Triangles = std::vector<std::array<uint32_t, 3>>;

  /// Keeps references to both. There is at least one triangle.
  TriangleGrid(const std::vector<WorldPoint>& vertices, const Triangles& triangles);
  explicit TriangleGrid(const TriangleMesh& mesh) : TriangleGrid(mesh.vertices, mesh.triangles) {}

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
  bool is_facing(size_t triangle, WorldPoint direction) const;
  double distance_sq(WorldPoint p) const { return nearest(p).distance_sq; }

 private:
  using Cell = std::array<int64_t, 3>;

  struct CellBox {
    Cell lo, hi;
    int64_t count() const { return (hi[0] - lo[0] + 1) * (hi[1] - lo[1] + 1) * (hi[2] - lo[2] + 1); }
  };

  void choose_cells(WorldPoint lo, WorldPoint hi);
  Cell cell_of(WorldPoint p) const;
  CellBox cells_of(size_t triangle) const;
  template <class Visit>
  void for_each_cell_of(size_t triangle, Visit visit) const;
  template <class Accept>
  MeshPoint search(WorldPoint p, double farthest_sq, Accept accept) const;
  template <class Visit>
  void for_each_cell_of_ring(Cell middle, int64_t ring, Visit visit) const;
  double reach_of(Cell middle, int64_t ring, WorldPoint p) const;
  size_t number_of(Cell c) const { return size_t((c[2] * dims_[1] + c[1]) * dims_[0] + c[0]); }

  const std::vector<WorldPoint>& vertices_;
  const Triangles& list_;
  std::array<double, 3> origin_{};
  double edge_ = 1;  ///< of a cell
  Cell dims_{1, 1, 1};
  std::vector<uint32_t> first_;  ///< by cell, into triangles_
  std::vector<uint32_t> triangles_;
};

}  // namespace isoshell
