// Everything that can be counted and measured of any triangle mesh by itself, as it is stored: the mesh of a
// certificate.
#pragma once

#include <array>
#include <cstdint>

#include "isoshell/backend.h"
#include "isoshell/quality.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// By indices; triangles that repeat a corner belong to none of it but their own count.
struct ComponentCounts {
  int64_t components = 0;           ///< of referenced vertices, connected through edges
  int64_t closed_components = 0;    ///< that are closed 2-manifolds
  int64_t bordered_components = 0;  ///< that are 2-manifolds with borders
  int64_t nonorientable_components = 0;
  int64_t inverted_components = 0;  ///< closed, consistently oriented ones of negative volume
  int64_t genus = 0;                ///< sum over the closed orientable components
};

struct ComplexCounts : ComponentCounts {
  int64_t vertices = 0, triangles = 0;  ///< as stored
  int64_t edges = 0;
  int64_t referenced_vertices = 0;
  int64_t duplicate_vertices = 0;    ///< at the position of another one, beyond the first
  int64_t repeated_corners = 0;      ///< triangles with a corner repeated
  int64_t duplicate_triangles = 0;   ///< with the corners of another one, in any order, beyond the first
  int64_t euler = 0;                 ///< V - E + F of the referenced vertices
  int64_t boundary_edges = 0;        ///< with one face
  int64_t boundary_loops = 0;        ///< of these, followed through the faces around each vertex
  int64_t nonmanifold_edges = 0;     ///< with more than two faces
  int64_t inconsistent_edges = 0;    ///< with two faces that traverse it in the same direction
  int64_t nonmanifold_vertices = 0;  ///< on a non-manifold edge, or whose faces are not one fan
  int64_t bow_ties = 0;              ///< those of them on no non-manifold edge
  bool closed_manifold = false;      ///< all components are closed 2-manifolds
  double volume_world = 0;           ///< signed, about the middle of the bounding box
};

/// Of vertices by the edges that meet there. Interior ones are on no edge with one face.
struct ValenceCounts {
  int64_t interior = 0, boundary = 0;
  int64_t smallest = 0, largest = 0;
  std::array<int64_t, 16> interior_with{};  ///< so many edges; the last also counts all with more
  double irregular_ratio = 0;               ///< interior vertices with other than six edges, of the interior ones
  double boundary_irregular_ratio = 0;      ///< boundary vertices with other than four edges, of those
  double with_5_to_7_pct = 0;               ///< interior vertices with five to seven edges
};

/// Each edge once.
struct EdgeStatistics {
  double mean = 0, deviation = 0, min = 0, max = 0;
  double variation() const { return mean > 0 ? deviation / mean : 0; }
};

/// A triangle that repeats a corner, or is a point, has Q 0 and the angles 0, 0 and 180 degrees.
struct TriangleShapes {
  double q_min = 0, q_mean = 0;  ///< Q = 6 / sqrt(3) * inradius / longest edge
  double angle_min_deg = 0, angle_max_deg = 0;
  double smallest_angle_mean_deg = 0;                           ///< over the triangles
  double below_10_pct = 0, below_20_pct = 0, below_30_pct = 0;  ///< by their smallest angle
  double above_90_pct = 0, above_120_pct = 0;                   ///< by their largest angle
  int64_t below_1 = 0;                                          ///< triangles with an angle below one degree
  int64_t degenerate = 0;  ///< a corner repeated, or smallest height below 1e-7 of the longest edge
  int64_t without_area = 0;
  double area_world = 0, area_variation = 0;                                      ///< sum; standard deviation over mean
  std::array<int64_t, 20> q_histogram{};                                          ///< triangles, from 0 to 1
  std::array<int64_t, 12> smallest_angle_histogram{}, largest_angle_histogram{};  ///< 0 to 60, 60 to 180 degrees
};

struct MeshCensus {
  ComplexCounts counts;
  ValenceCounts valence;
  EdgeStatistics edges;
  TriangleShapes shapes;
  LeastDihedral dihedral;
  double diagonal_world = 0;  ///< of the bounding box of referenced vertices
  int64_t intersecting_pairs = 0, intersecting_triangles = 0;
};

/// `dropped` triangles with a repeated corner were left out by a reader and are counted with those of the mesh.
/// Intersections: pairs of triangles that meet outside of the corners that they share, exactly tested in double
/// precision, touching included; vertices of one position are one there. Result: sums run in one fixed shape. Cost:
/// sorts of edges and vertices, a tree of boxes; about 150 bytes a triangle. Throws: usage for no triangle, too many
/// for 32-bit half-edges, and one that names a vertex that is not there or not finite; interrupted.
MeshCensus take_census(const TriangleMesh& mesh, Context& context, int64_t dropped = 0);

/// The pairs alone. Throws: as take_census.
int64_t count_intersecting_pairs(const TriangleMesh& mesh, Context& context);

/// Positions and triangles of a mesh, vertices of one position as one.
TriangleMesh with_joined_vertices(const TriangleMesh& mesh);

}  // namespace isoshell
