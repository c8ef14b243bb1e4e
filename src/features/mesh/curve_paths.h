// The curves of a network as paths with arclengths.
#pragma once

#include <cstddef>
#include <vector>

#include "features/mesh/feature_mesh.h"
#include "features/mesh/mesh_fans.h"

namespace isoshell {

/// A point on a path.
struct PathPoint {
  size_t edge = 0;  ///< of the path
  double part = 0;  ///< of the edge that is before it: 0 to less than 1
};

/// A part of a curve between two corners, or a loop. Lengths are in 1/256 voxel.
struct CurvePath {
  uint32_t curve = 0;  ///< of the network
  CurveKind kind = CurveKind::crease;
  bool is_loop = false;          ///< an edge joins the last vertex to the first, which is not repeated
  std::vector<uint32_t> vertex;  ///< an open path begins and ends with corners, which may be the same one
  std::vector<double> at;        ///< per vertex the arclength from the first one
  double length = 0;
  int64_t least_segments = 1;    ///< that keep edges of the result apart
  bool is_jagged = false;        ///< its turns are no bends: see find_jagged_paths
  std::vector<PathPoint> seeds;  ///< along it; an open path has them at its corners, too

  size_t edge_count() const { return is_loop ? vertex.size() : vertex.size() - 1; }
  uint32_t edge_end(size_t edge) const { return vertex[(edge + 1) % vertex.size()]; }
};

/// The paths of all curves, by curve, then along it, without seeds. Paths between the same two corners take two
/// segments, and what returns to where it began takes three: so no two edges of the result have the same ends. Where
/// the border turns back in the middle of a curve, around a vertex that joins both of its sides, there is a corner,
/// too. Throws: usage where the network is not on edges of the mesh, or leaves out an edge that has not two triangles.
std::vector<CurvePath> curve_paths(const std::vector<WorldPoint>& position, const MeshTriangles& triangles,
                                   const CurveNetwork& network);

/// The keys of its edges, along it.
void append_edges(const FeatureCurve& curve, std::vector<uint64_t>& edges);

/// The keys of their edges, ascending.
std::vector<uint64_t> path_edges(const std::vector<CurvePath>& paths);

/// Arclengths and length from positions.
void measure_path(const std::vector<WorldPoint>& position, CurvePath& path);
double length_of(const std::vector<WorldPoint>& position, const FeatureCurve& curve);

/// Marks the borders, and edges of three faces or more, that turn much, but within four edge lengths mostly back again.
/// `edge_length` in 1/256 voxel.
void find_jagged_paths(const std::vector<WorldPoint>& position, double edge_length, std::vector<CurvePath>& paths);

}  // namespace isoshell
