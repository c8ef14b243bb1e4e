// Point clouds as input: the closed surface that the points lie on.
#pragma once

#include <string>
#include <vector>

#include "isoshell/io/volume_file.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// Points in world units; `normal` is empty, or one a point, of any length.
struct PointCloud {
  std::vector<WorldPoint> position, normal;
  DirtCounts dirt;  ///< what was left out
};

/// Reads points. `format` is "ply", "xyz" or "pcd", empty: by the path: PLY whatever its faces, text rows of x y z and
/// perhaps a normal (.xyz), and PCD as text, binary or packed. Colours and other columns are passed over. `path` "-"
/// reads standard input. Throws: unreadable_input, nothing_to_mesh when there is no point, out_of_memory before reading
/// takes more than `memory_limit_bytes`, if above 0.
PointCloud read_points(const std::string& path, const std::string& format = "", int64_t memory_limit_bytes = 0);

/// A PLY file holds a mesh, or points: vertices of which no face makes a triangle with area.
struct PlyContent {
  bool is_points = false;
  TriangleSoup mesh;  ///< empty when it is points
  PointCloud points;
  int64_t unusable_faces = 0;  ///< of points: the file's faces, all of them; `points.dirt` says why
};

/// Reads either, once, so that pipes and standard input ("-") do. Throws: as read_mesh and read_points.
PlyContent read_ply_content(const std::string& path, int64_t memory_limit_bytes = 0);

/// What the surface was made with.
struct PointSurfaceInfo {
  int64_t points = 0;           ///< different ones
  int64_t outliers = 0;         ///< of these, left out: far from all others
  double spacing_world = 0;     ///< typical distance of a point from its neighbours
  double voxel_size_world = 0;  ///< of the grid that the surface comes from; details below it are lost
  bool normals_given = false, normals_turned = false;
  bool normals_ignored = false;  ///< they do not stand on the planes of their neighbours; others were estimated
  double unflat_part = 0;        ///< of the points whose normals were estimated, those that are near no plane together
                                 ///< with their neighbours: most of them where the points fill a volume
  bool sharp = false;            ///< points lie on sharp sides, whose creases the surface has
  double held_part = 1;          ///< of the points, by area, those that are near to the surface
  double open_part = 0;          ///< of the surface's vertices, those that bridge where there are no points
};

/// The surface of the points: the level of a smooth indicator function whose gradient is the points' normals (Poisson
/// reconstruction), drawn onto the points where any look its way. Result: closed, 2-manifold, oriented outward; a scan
/// from one side is closed on its back, and hollows are left out but where the points' own normals look into them.
/// Normals that are missing, or that stand on the planes of their neighbours no more than any would, or badly where
/// those are flat, are estimated from neighbours, those that disagree are turned along a spanning tree, and all of them
/// so that they point away from the middle, or up where the points are flat. Up to a tenth of the points is left out
/// where they lie several times as far from their neighbours as others do. Where creases are wanted and the points are
/// those of a sharp body, no more than a tenth of their spacing off its sides, the surface is where the distance from
/// these sides is 0, with vertices on their creases. `keep_open`: what is twice as far from points as these are from
/// one another is left out, with a border. The same for any number of threads. Cost: 13 bytes a voxel of the points'
/// box. Throws: nothing_to_mesh for fewer than four different points, and where keep_open leaves nothing; out_of_memory
/// over `memory_limit_bytes`, if above 0.
TriangleSoup surface_of_points(const PointCloud& cloud, int64_t memory_limit_bytes, PointSurfaceInfo& info,
                               VolumeCreases creases = VolumeCreases::none, bool keep_open = false);

}  // namespace isoshell
