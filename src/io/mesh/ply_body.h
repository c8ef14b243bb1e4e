// The two ways to the rows of a PLY file. Both fill the same sink.
#pragma once

#include <vector>

#include "io/mesh/face_collector.h"
#include "io/mesh/ply_attributes.h"
#include "io/mesh/ply_header.h"

namespace isoshell {

/// What of a PLY file makes a mesh. Null elements and -1 mean: not there.
struct PlyMeshLayout {
  const PlyElement *vertices = nullptr, *faces = nullptr, *strips = nullptr;
  int xyz[3] = {-1, -1, -1};                  ///< properties of `vertices`
  int face_corners = -1, strip_corners = -1;  ///< list properties
  std::vector<PlyColumn> columns;             ///< of `vertices`, that are kept beside the positions
};

/// What was read. The collectors know where the vertices are: join them before it moves.
struct PlyBody {
  explicit PlyBody(const MeshSource& source) : vertices(source, 0) {}

  /// For all vertices of the layout, which is not null.
  void make_room(const MeshSource& source, const PlyMeshLayout& layout) {
    vertices = VertexTable(source, layout.vertices->count);
    for (VertexAttribute& a : attributes) a.values.resize(vertices.points.size() * size_t(a.components));
  }
  double& value_at(const PlyColumn& column, int64_t row) {
    VertexAttribute& a = attributes[column.attribute];
    return a.values[size_t(row * a.components + column.component)];
  }

  VertexTable vertices;
  std::vector<VertexAttribute> attributes;  ///< those that the layout's columns name
  std::vector<FaceCollector> faces;         ///< and strips, in the order of the file, made as needed
  DirtCounts dirt;                          ///< what the header does not declare; nothing else is counted here
};

/// Either way. Throws: unreadable_input for fewer rows, or fewer values in a row, than the header promises.
void read_ply_body(const MeshSource& source, const PlyHeader& header, const PlyMeshLayout& layout, PlyBody& body);
void read_ply_text(const MeshSource& source, const PlyHeader& header, const PlyMeshLayout& layout, PlyBody& body);
void read_ply_binary(const MeshSource& source, const PlyHeader& header, const PlyMeshLayout& layout, PlyBody& body);

/// Hands one row's corners over: as a face, or as strips between separators of -1.
/// `refuse(what)` throws with the place of the row.
template <class Refuse>
void add_ply_row(const std::vector<int64_t>& corners, bool is_strip, int64_t vertex_count,
                 std::vector<uint32_t>& scratch, FaceCollector& faces, Refuse refuse) {
  scratch.clear();
  for (const int64_t index : corners) {
    if (is_strip && index == -1) {
      if (!scratch.empty()) faces.add_strip(scratch.data(), int64_t(scratch.size()));
      scratch.clear();
      continue;
    }
    if (index < 0 || index >= vertex_count)
      refuse("a face names vertex " + std::to_string(index) + "; the file holds vertices 0 to " +
             std::to_string(vertex_count - 1) + "; correct the index or restore the missing vertices");
    scratch.push_back(uint32_t(index));
  }
  if (!is_strip) {
    faces.add_polygon(scratch.data(), int64_t(scratch.size()));
  } else if (!scratch.empty()) {
    faces.add_strip(scratch.data(), int64_t(scratch.size()));
  }
}

}  // namespace isoshell
