// PLY: positions and numbers of vertices, polygons and triangle strips; everything else is passed over.
#include "io/mesh/mesh_readers.h"
#include "io/mesh/ply_body.h"

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

// Values that no property declares shift the rows behind them, most of all in a binary file, and a wrong count gives
// the rows of one element to the next. Either shows where corners are looked for: lists come out too short for a face.
void refuse_shifted_rows(const MeshSource& source, const DirtCounts& dirt) {
  if (dirt.short_faces == 0 || dirt.long_rows + dirt.surplus_rows + dirt.surplus_bytes == 0) return;
  source.refuse("holds more than its header declares (" + std::to_string(dirt.long_rows) + " rows too long, " +
                std::to_string(dirt.surplus_rows) + " rows and " + std::to_string(dirt.surplus_bytes) +
                " bytes too many) and " + std::to_string(dirt.short_faces) +
                " faces of fewer than three corners, as if rows were taken for others; correct the header");
}

}  // namespace

void read_ply_body(const MeshSource& source, const PlyHeader& header, const PlyMeshLayout& layout, PlyBody& body) {
  if (header.encoding == PlyEncoding::ascii)
    read_ply_text(source, header, layout, body);
  else
    read_ply_binary(source, header, layout, body);
}

TriangleSoup read_ply_faces(const MeshSource& source) {
  const PlyHeader header = read_ply_header(source);
  PlyMeshLayout layout = find_layout(source, header);
  PlyBody body(source);
  PlyAttributes properties;
  if (layout.vertices) properties = find_ply_attributes(*layout.vertices);
  layout.columns = std::move(properties.columns);
  body.attributes = std::move(properties.attributes);
  read_ply_body(source, header, layout, body);
  TriangleSoup soup = join_parts(std::move(body.vertices), body.faces);
  soup.attributes = std::move(body.attributes);
  soup.dropped_attributes = std::move(properties.dropped);
  soup.dirt.long_rows = body.dirt.long_rows;
  soup.dirt.surplus_rows = body.dirt.surplus_rows;
  soup.dirt.surplus_bytes = body.dirt.surplus_bytes;
  refuse_shifted_rows(source, soup.dirt);
  return soup;
}

TriangleSoup read_ply(const MeshSource& source) {
  TriangleSoup soup = read_ply_faces(source);
  if (soup.faces_in_file == 0 && !soup.vertices.empty())
    source.nothing_to_mesh("holds " + std::to_string(soup.vertices.size()) +
                           " points and no face; read it as a point cloud, or give a file with faces");
  require_triangles(source, soup);
  return soup;
}

}  // namespace isoshell
