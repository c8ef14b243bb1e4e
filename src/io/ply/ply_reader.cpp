// PLY: positions and numbers of vertices, polygons with their numbers and corners, and triangle strips; everything else
// is passed over.
#include "io/ply/ply_reader.h"

#include <algorithm>
#include <cmath>

#include "core/attribute_values.h"
#include "io/bytes/text_scan.h"
#include "io/ply/ply_body.h"
#include "io/ply/ply_regions.h"

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

namespace {

/// What the layout keeps of faces.
PlyAttributes keep_faces(const PlyHeader& header, PlyMeshLayout& layout, PlyAttributes& of_vertices) {
  if (!layout.faces || layout.faces->count == 0) return {};
  PlyAttributes found = find_face_attributes(header, *layout.faces);
  if (layout.strips && layout.strips->count > 0) {
    for (const Attribute& a : found.attributes)
      of_vertices.dropped.push_back({a.name, "the triangle strips of the file have none"});
    found.attributes.clear();
    return found;
  }
  layout.face_columns = found.columns;
  layout.corner_lists = found.lists;
  return found;
}

/// What was read of faces, for the triangles that they became.
void add_face_attributes(const MeshSource& source, const PlyMeshLayout& layout, const PlyBody& body,
                         std::vector<Attribute> attributes, TriangleSoup& soup) {
  const std::vector<size_t> first = triangles_first(body.faces);
  for (Attribute& a : attributes)
    resize_counted(source, a.values,
                   (a.domain == AttributeDomain::face ? 1 : 3) * soup.triangles.size() * size_t(a.components));
  for_each_chunk(int64_t(body.face_rows.size()), [&](int64_t part) {
    const PlyFaceRows& rows = body.face_rows[size_t(part)];
    const std::vector<uint32_t>& face_of = body.faces[size_t(part)].face_of();
    CornerFinder corners(rows.corners);
    for (size_t i = 0; i < face_of.size(); ++i) {
      const size_t t = first[size_t(part)] + i;
      for (size_t c = 0; c < layout.face_columns.size(); ++c) {
        const PlyColumn& column = layout.face_columns[c];
        Attribute& a = attributes[column.attribute];
        a.values[t * size_t(a.components) + size_t(column.component)] = rows.columns[c][face_of[i]];
      }
      if (layout.corner_lists.empty()) continue;
      corners.find(face_of[i], soup.triangles[t], [&](size_t corner, size_t in_list) {
        for (size_t l = 0; l < layout.corner_lists.size(); ++l) {
          const size_t size = size_t(layout.corner_lists[l].components);
          std::copy_n(&rows.lists[l][in_list * size], size,
                      &attributes[layout.corner_lists[l].attribute].values[(3 * t + corner) * size]);
        }
      });
    }
  });
  for (Attribute& a : attributes) soup.attributes.push_back(std::move(a));
}

/// Normals and texture coordinates belong to corners: vertices may be there twice where they jump. Those that faces
/// have come before.
void add_vertex_attributes(const MeshSource& source, std::vector<Attribute> attributes,
                           const std::vector<Attribute>& of_faces, TriangleSoup& soup) {
  for (Attribute& a : attributes) {
    const AttributeMeaning* const meaning = fitting_meaning(a);
    const bool is_of_corners = meaning && meaning->domain == AttributeDomain::corner && !soup.triangles.empty();
    const auto is_same = [&](const Attribute& b) { return b.domain == AttributeDomain::corner && b.name == a.name; };
    if (is_of_corners && std::any_of(of_faces.begin(), of_faces.end(), is_same)) {
      soup.dropped_attributes.push_back({a.name + " of vertices", "the faces have their own"});
      continue;
    }
    if (is_of_corners) spread_to_corners(source, soup.triangles, a);
    soup.attributes.push_back(std::move(a));
  }
}

/// Labels that do not fit their numbers are no labels.
void drop_wrong_labels(std::vector<Attribute>& attributes) {
  for (Attribute& a : attributes)
    if (!std::all_of(a.values.begin(), a.values.end(),
                     [&](double n) { return n >= -1 && n < double(a.labels.size()) && n == std::floor(n); }))
      a.labels.clear();
}

}  // namespace

TriangleSoup read_ply_faces(const MeshSource& source) {
  const PlyHeader header = read_ply_header(source);
  PlyMeshLayout layout = find_layout(source, header);
  PlyBody body(source);
  PlyAttributes of_vertices;
  if (layout.vertices) of_vertices = find_ply_attributes(*layout.vertices);
  PlyAttributes of_faces = keep_faces(header, layout, of_vertices);
  layout.columns = std::move(of_vertices.columns);
  body.attributes = std::move(of_vertices.attributes);
  read_ply_body(source, header, layout, body);
  TriangleSoup soup = join_parts(std::move(body.vertices), body.faces);
  soup.dropped_attributes = std::move(of_vertices.dropped);
  soup.dropped_attributes.insert(soup.dropped_attributes.end(), of_faces.dropped.begin(), of_faces.dropped.end());
  add_vertex_attributes(source, std::move(body.attributes), of_faces.attributes, soup);
  add_face_attributes(source, layout, body, std::move(of_faces.attributes), soup);
  drop_wrong_labels(soup.attributes);
  take_regions(source, header, soup);
  soup.files = find_files(header);
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
