// The curves of a network as paths with arclengths, and how many seeds they get.
#pragma once

#include <cstddef>
#include <vector>

#include "features/feature_mesh.h"
#include "features/mesh_fans.h"

namespace isoshell {

/// A part of a curve between two corners, or a loop. Lengths are in 1/256 voxel.
struct CurvePath {
  uint32_t curve = 0;  ///< of the network
  CurveKind kind = CurveKind::crease;
  bool is_loop = false;          ///< an edge joins the last vertex to the first, which is not repeated
  std::vector<uint32_t> vertex;  ///< an open path begins and ends with corners, which may be the same one
  std::vector<double> at;        ///< per vertex the arclength from the first one
  double length = 0;
  int64_t least_segments = 1;

  size_t edge_count() const { return is_loop ? vertex.size() : vertex.size() - 1; }
  uint32_t edge_end(size_t edge) const { return vertex[(edge + 1) % vertex.size()]; }
};

/// Equal parts of about an edge length that a path is cut into by its seeds. Paths between the same two corners have a
/// seed between them, and what returns to where it began has two: so no two edges of the result have the same ends.
inline int64_t segments_of(double length, int64_t least_segments, double edge_length) {
  const auto nearest = int64_t(length / edge_length + 0.5);
  return nearest > least_segments ? nearest : least_segments;
}

/// The paths of all curves, by curve, then along it. Where the border turns back in the middle of a curve, around a
/// vertex that joins both of its sides, there is a corner, too. Throws: usage where the network is not on edges of the
/// mesh, or leaves out an edge that has not two triangles.
std::vector<CurvePath> curve_paths(const std::vector<WorldPoint>& position, const MeshTriangles& triangles,
                                   const CurveNetwork& network);

/// Arclengths and length from positions.
void measure_path(const std::vector<WorldPoint>& position, CurvePath& path);

}  // namespace isoshell
