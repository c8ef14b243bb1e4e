// Distances of points to a mesh, by a grid of cells that list the triangles whose boxes meet them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "isoshell/triangle_mesh.h"

namespace isoshell {

class TriangleGrid {
 public:
  /// Keeps a reference to the mesh, which has at least one triangle.
  explicit TriangleGrid(const TriangleMesh& mesh);

  /// Squared distance of p to the nearest point of the mesh.
  double distance_sq(WorldPoint p) const;

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
  void look_into(Cell cell, WorldPoint p, double& best_sq) const;
  void look_into_ring(Cell middle, int64_t ring, WorldPoint p, double& best_sq) const;
  double reach_of(Cell middle, int64_t ring, WorldPoint p) const;
  size_t number_of(Cell c) const { return size_t((c[2] * dims_[1] + c[1]) * dims_[0] + c[0]); }

  const TriangleMesh& mesh_;
  std::array<double, 3> origin_{};
  double edge_ = 1;  ///< of a cell
  Cell dims_{1, 1, 1};
  std::vector<uint32_t> first_;  ///< by cell, into triangles_
  std::vector<uint32_t> triangles_;
};

}  // namespace isoshell
