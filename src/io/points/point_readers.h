// One reader a format of points. Each throws as read_points() does; points that are not finite are still in the result.
#pragma once

#include "io/bytes/mesh_source.h"
#include "isoshell/io/point_file.h"

namespace isoshell {

PointCloud read_ply_points(const MeshSource& source);
PointCloud read_xyz(const MeshSource& source);
PointCloud read_pcd(const MeshSource& source);

}  // namespace isoshell
