// The two ways to the rows of a PLY file. Both fill the same sink.
#pragma once

#include <vector>

#include "io/faces/face_corners.h"
#include "io/ply/ply_attributes.h"
#include "io/ply/ply_header.h"

namespace isoshell {

/// What of a PLY file makes a mesh. Null elements and -1 mean: not there.
struct PlyMeshLayout {
  const PlyElement *vertices = nullptr, *faces = nullptr, *strips = nullptr;
  int xyz[3] = {-1, -1, -1};                  ///< properties of `vertices`
  int face_corners = -1, strip_corners = -1;  ///< list properties
  std::vector<PlyColumn> columns;             ///< of `vertices`, that are kept beside the positions
  std::vector<PlyColumn> face_columns;        ///< of `faces`, beside the corners
  std::vector<PlyCornerList> corner_lists;    ///< likewise

  bool keeps_faces() const { return !face_columns.empty() || !corner_lists.empty(); }
  FaceCollector collector(const VertexTable& table) const {
    return FaceCollector(table, keeps_faces() ? FaceCollector::Keep::faces_too : FaceCollector::Keep::triangles);
  }
};

/// What is kept of a part of the faces beside their triangles.
struct PlyFaceRows {
  explicit PlyFaceRows(const PlyMeshLayout& layout)
      : columns(layout.face_columns.size()), lists(layout.corner_lists.size()) {}

  FaceCorners corners;
  std::vector<std::vector<double>> columns;  ///< of the layout's face columns, a value a face
  std::vector<std::vector<double>> lists;    ///< of its corner lists, the values of each corner
};

/// What was read. The collectors know where the vertices are: join them before it moves.
struct PlyBody {
  explicit PlyBody(const MeshSource& source) : vertices(source, 0) {}

  /// For all vertices of the layout, which is not null.
  void make_room(const MeshSource& source, const PlyMeshLayout& layout) {
    vertices = VertexTable(source, layout.vertices->count);
    for (Attribute& a : attributes) resize_counted(source, a.values, vertices.points.size() * size_t(a.components));
  }
  double& value_at(const PlyColumn& column, int64_t row) {
    Attribute& a = attributes[column.attribute];
    return a.values[size_t(row * a.components + column.component)];
  }

  VertexTable vertices;
  std::vector<Attribute> attributes;   ///< those that the layout's columns name
  std::vector<FaceCollector> faces;    ///< and strips, in the order of the file, made as needed
  std::vector<PlyFaceRows> face_rows;  ///< one a collector, if the layout keeps some of them
  DirtCounts dirt;                     ///< what the header does not declare; nothing else is counted here
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
    if (index < 0 || index >= vertex_count) refuse(no_such_vertex("a face", std::to_string(index), vertex_count));
    scratch.push_back(uint32_t(index));
  }
  if (!is_strip) {
    faces.add_polygon(scratch.data(), int64_t(scratch.size()));
  } else if (!scratch.empty()) {
    faces.add_strip(scratch.data(), int64_t(scratch.size()));
  }
}

/// Ends a face: its vertices and the list that the row had for each of the layout's, which is empty or fits them.
template <class Refuse>
void add_face_row(const MeshSource& source, const std::vector<uint32_t>& vertices,
                  const std::vector<std::vector<double>>& lists, const PlyMeshLayout& layout, PlyFaceRows& rows,
                  Refuse refuse) {
  make_room(source, rows.corners.vertex, vertices.size());
  make_room(source, rows.corners.first, 1);
  rows.corners.vertex.insert(rows.corners.vertex.end(), vertices.begin(), vertices.end());
  rows.corners.end_face();
  for (size_t i = 0; i < lists.size(); ++i) {
    const size_t wanted = vertices.size() * size_t(layout.corner_lists[i].components);
    if (!lists[i].empty() && lists[i].size() != wanted)
      refuse("a face of " + std::to_string(vertices.size()) + " corners has " + std::to_string(lists[i].size()) +
             " values in its list " + layout.faces->properties[size_t(layout.corner_lists[i].property)].name + "; " +
             std::to_string(layout.corner_lists[i].components) + " a corner are needed, or none; correct the list");
    make_room(source, rows.lists[i], wanted);
    rows.lists[i].insert(rows.lists[i].end(), lists[i].begin(), lists[i].end());
    if (lists[i].empty()) rows.lists[i].resize(rows.lists[i].size() + wanted, std::nan(""));
  }
}

}  // namespace isoshell
