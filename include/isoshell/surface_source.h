// What comes in, in world units, as given.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "isoshell/advanced/lattice.h"
#include "isoshell/attribute.h"
#include "isoshell/regions.h"

namespace isoshell {

/// What a reader or the first look at the geometry dropped or found, by kind. Every kind with a count is one warning.
struct DirtCounts {
  int64_t nonfinite_vertices = 0;  ///< NaN or infinite; their faces are dropped
  int64_t dropped_faces_nonfinite = 0;
  int64_t short_faces = 0;       ///< faces of fewer than three corners, dropped
  int64_t degenerate_faces = 0;  ///< repeated corner or zero area in the file, dropped
  int64_t duplicate_faces = 0;   ///< same corners as another face, in whatever order; kept once per orientation
  int64_t unreferenced_vertices = 0;
  int64_t nonmanifold_edges = 0;   ///< shared by more than two faces
  int64_t inconsistent_edges = 0;  ///< shared by two faces that disagree about the orientation
  // What a glTF file holds that is not read.
  int64_t other_primitives = 0;  ///< of points and lines, or without positions
  int64_t posed_meshes = 0;      ///< meshes with skins or morph targets, which stand as they are stored
  // What a PLY file holds beyond what its header declares; all of it is passed over.
  int64_t long_rows = 0;      ///< text rows with values behind their last property, of elements that were read
  int64_t surplus_rows = 0;   ///< text rows behind the last one
  int64_t surplus_bytes = 0;  ///< bytes behind the last row of a binary file, or behind a .glb file
};

/// Vertices that were pulled back, as needles narrower than edges held them far away from the rest.
struct FarVertexReport {
  int64_t vertices = 0;
  double distance_world = 0;     ///< of the farthest one from the rest
  WorldPoint farthest{0, 0, 0};  ///< where it was
};

/// Triangles in world units. Indices are in range; positions are finite for every referenced vertex.
struct TriangleSoup {
  std::vector<WorldPoint> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  int64_t faces_in_file = 0;         ///< polygons and strips before they were split
  uint32_t first_cap = 0xffffffffu;  ///< triangles from this one on were added to close holes
  DirtCounts dirt;
  std::vector<Attribute> attributes;                 ///< as read; what repair or union changed has none
  AttributeFiles files;                              ///< that attributes speak of
  std::vector<DroppedAttribute> dropped_attributes;  ///< of the file, that no reader takes
  FaceRegions regions;                               ///< that the triangles part; empty: they bound one solid
  /// Of voxels: pairs of regions that touched in islands alone, which were absorbed; ascending, the smaller first.
  std::vector<std::array<int32_t, 2>> absorbed_walls = {};
  FarVertexReport far = {};  ///< what pull_back_far_vertices() has moved
};

}  // namespace isoshell
