#include "isoshell/io/memory_input.h"

#include "io/faces/face_collector.h"
#include "isoshell/readable.h"

namespace isoshell {

TriangleSoup split_polygons(PolygonSoup polygons, const std::string& name) {
  const MeshSource source(name, {});
  VertexTable vertices(source, int64_t(polygons.vertices.size()));
  vertices.points = std::move(polygons.vertices);
  vertices.count_nonfinite();
  const size_t vertex_count = vertices.points.size();
  std::vector<FaceCollector> parts(1, FaceCollector(vertices));
  size_t corner = 0;
  for (size_t f = 0; f < polygons.sizes.size(); ++f) {
    const size_t end = corner + polygons.sizes[f];
    if (end > polygons.corners.size())
      source.refuse("face " + std::to_string(f) + " ends behind the last corner; sizes of faces must sum up to " +
                    std::to_string(polygons.corners.size()));
    for (size_t c = corner; c < end; ++c)
      if (polygons.corners[c] >= vertex_count)
        source.refuse("face " + std::to_string(f) + " has vertex " + std::to_string(polygons.corners[c]) +
                      " of a surface of " + counted(int64_t(vertex_count), "vertex", "vertices") +
                      "; indices count from 0 and are below that");
    parts[0].add_polygon(polygons.corners.data() + corner, polygons.sizes[f]);
    corner = end;
  }
  if (corner != polygons.corners.size())
    source.refuse("its faces have " + std::to_string(corner) + " corners, and " +
                  std::to_string(polygons.corners.size()) + " are given; sizes of faces must sum up to that");
  return join_soup(source, std::move(vertices), parts);
}

}  // namespace isoshell
