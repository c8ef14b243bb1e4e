// PLY: positions, polygons and triangle strips; every other element and property is passed over.
#include "io/mesh_readers.h"
#include "io/ply_body.h"

namespace isoshell {
namespace {

// The list of corners of faces or strips.
int corner_list(const MeshSource& source, const PlyElement& element) {
  for (const char* name : {"vertex_indices", "vertex_index"}) {
    const int i = element.find(name);
    if (i >= 0 && element.properties[size_t(i)].is_list) return i;
  }
  if (element.count > 0)
    source.refuse_line_at(
        element.header_line,
        "element " + element.name + " has no list property vertex_indices; without it there are no faces");
  return -1;
}

PlyMeshLayout find_layout(const MeshSource& source, const PlyHeader& header) {
  PlyMeshLayout layout;
  layout.vertices = header.find("vertex");
  layout.faces = header.find("face");
  layout.strips = header.find("tristrips");
  if (layout.faces) layout.face_corners = corner_list(source, *layout.faces);
  if (layout.strips) layout.strip_corners = corner_list(source, *layout.strips);
  const char* const names[] = {"x", "y", "z"};
  for (int axis = 0; layout.vertices && axis < 3; ++axis) {
    layout.xyz[axis] = layout.vertices->find(names[axis]);
    if (layout.xyz[axis] < 0 || layout.vertices->properties[size_t(layout.xyz[axis])].is_list)
      source.refuse_line_at(layout.vertices->header_line, std::string("element vertex has no number named ") +
                                                              names[axis] + "; x, y and z are needed");
  }
  return layout;
}

}  // namespace

TriangleSoup read_ply(const MeshSource& source) {
  const PlyHeader header = read_ply_header(source);
  const PlyMeshLayout layout = find_layout(source, header);
  VertexTable vertices(source, 0);
  std::vector<FaceCollector> faces;
  if (header.encoding == PlyEncoding::ascii)
    read_ply_text(source, header, layout, vertices, faces);
  else
    read_ply_binary(source, header, layout, vertices, faces);
  const bool has_faces = (layout.faces && layout.faces->count > 0) || (layout.strips && layout.strips->count > 0);
  if (!has_faces && !vertices.points.empty())
    source.nothing_to_mesh("holds " + std::to_string(vertices.points.size()) +
                           " points and no face; read it as a point cloud, or give a file with faces");
  return join_soup(source, std::move(vertices), faces);
}

}  // namespace isoshell
