// The body of a PLY file as text: a row a line, in parallel.
#include <numeric>

#include "core/number_type.h"
#include "io/bytes/text_scan.h"
#include "io/ply/ply_body.h"

namespace isoshell {
namespace {

// One row of one element. Tokens are judged as they are passed; a row that goes on behind its last property is added to
// `long_rows`.
class RowReader {
 public:
  RowReader(const Text& text, const PlyElement& element, const char* p, const char* end, int64_t& long_rows)
      : text_(text), element_(element), p_(p), end_(end), long_rows_(long_rows) {}

  double real() {
    double value = 0;
    next();
    if (!parse_real(p_, end_, value)) refuse(p_, "a number is expected; found " + quoted_token(p_, end_));
    return value;
  }
  int64_t integer() {
    int64_t value = 0;
    const char* const token = next();
    if (!parse_integer(p_, end_, value) || !ends_token(p_, end_))
      refuse(token, "an integer is expected; found " + quoted_token(token, end_));
    return value;
  }
  int64_t list_length() {
    const int64_t length = integer();
    if (length < 0 || length > (end_ - p_) / 2 + 1)
      refuse(p_, "a list promises " + std::to_string(length) + " items, more than its line can hold");
    return length;
  }
  void skip_value() {
    if (const char* const token = next(); token == end_ || *token == '\n')
      refuse(token, "the row ends before its last property");
    p_ = skip_token(p_, end_);
  }
  void skip(const PlyProperty& property) {
    for (int64_t left = property.is_list ? list_length() : 1; left > 0; --left) skip_value();
  }
  const char* finish() {
    if (const char* const token = next(); token < end_ && *token != '\n') ++long_rows_;
    return p_;
  }
  [[noreturn]] void refuse(const char* at, const std::string& what) const {
    text_.refuse(at, "element " + element_.name + ": " + what + "; the file does not match its header");
  }

 private:
  const char* next() { return p_ = skip_blanks(p_, end_); }

  const Text& text_;
  const PlyElement& element_;
  const char *p_, *end_;
  int64_t& long_rows_;
};

const char* read_vertex(RowReader row, const PlyMeshLayout& layout, int64_t number, PlyBody& body) {
  WorldPoint& point = body.vertices.points[size_t(number)];
  double* const xyz[] = {&point.x, &point.y, &point.z};
  auto column = layout.columns.begin();
  const int count = int(layout.vertices->properties.size());
  for (int i = 0; i < count; ++i) {
    const int axis = i == layout.xyz[0] ? 0 : i == layout.xyz[1] ? 1 : i == layout.xyz[2] ? 2 : -1;
    if (axis >= 0)
      *xyz[axis] = row.real();
    else if (column != layout.columns.end() && column->property == i)
      body.value_at(*column++, number) = nearest_of(layout.vertices->properties[size_t(i)].type, row.real());
    else
      row.skip(layout.vertices->properties[size_t(i)]);
  }
  return row.finish();
}

/// What of a row of faces or strips is kept.
struct FaceRow {
  std::vector<int64_t> corners;
  std::vector<std::vector<double>> lists;
  std::vector<uint32_t> vertices;
};

/// `rows` is null, and the layout's columns and lists are passed over, where there are only triangles to keep.
const char* read_face(const MeshSource& source, RowReader row, const PlyElement& element, int list,
                      const PlyMeshLayout& layout, PlyFaceRows* rows, FaceRow& to) {
  size_t column = 0, corner_list = 0;
  to.lists.resize(rows ? layout.corner_lists.size() : 0);
  for (int i = 0; i < int(element.properties.size()); ++i) {
    const PlyProperty& property = element.properties[size_t(i)];
    if (i == list) {
      resize_counted(source, to.corners, size_t(row.list_length()));
      for (int64_t& corner : to.corners) corner = row.integer();
    } else if (rows && column < layout.face_columns.size() && layout.face_columns[column].property == i) {
      make_room(source, rows->columns[column], 1);
      rows->columns[column++].push_back(nearest_of(property.type, row.real()));
    } else if (rows && corner_list < layout.corner_lists.size() && layout.corner_lists[corner_list].property == i) {
      std::vector<double>& values = to.lists[corner_list++];
      resize_counted(source, values, size_t(row.list_length()));
      for (double& value : values) value = nearest_of(property.type, row.real());
    } else {
      row.skip(property);
    }
  }
  return row.finish();
}

}  // namespace

void read_ply_text(const MeshSource& source, const PlyHeader& header, const PlyMeshLayout& layout, PlyBody& body) {
  const Text text(source);
  const TextRows rows(text, text.end() - (source.size() - header.body), TextRows::kNoComment);
  const auto row_count = [](const PlyElement& e) { return e.properties.empty() ? 0 : e.count; };
  int64_t promised = 0;
  for (const PlyElement& element : header.elements) promised += row_count(element);
  if (rows.count() < promised)
    text.refuse(text.end(), "the header promises " + std::to_string(promised) + " rows; the file holds " +
                                std::to_string(rows.count()) + "; correct the counts or restore the file");
  body.dirt.surplus_rows = rows.count() - promised;

  int64_t first = 0;
  std::vector<int64_t> long_rows(size_t(rows.chunk_count()), 0);
  VertexTable& vertices = body.vertices;
  const auto read_vertices = [&](const PlyElement& element) {
    body.make_room(source, layout);
    rows.for_each(first, first + element.count, [&](int64_t row, const char* p, const char* end, int64_t chunk) {
      return read_vertex(RowReader(text, element, p, end, long_rows[size_t(chunk)]), layout, row - first, body);
    });
    vertices.count_nonfinite();
  };
  const auto read_faces = [&](const PlyElement& element, int list) {
    std::vector<FaceCollector>& faces = body.faces;
    const size_t base = faces.size();
    const bool is_strip = &element == layout.strips, keeps_rows = layout.keeps_faces();
    faces.resize(base + size_t(rows.chunk_count()), layout.collector(vertices));
    if (keeps_rows) body.face_rows.resize(faces.size(), PlyFaceRows(layout));
    std::vector<FaceRow> scratch(size_t(rows.chunk_count()));
    const int64_t vertex_count = int64_t(vertices.points.size());
    rows.for_each(first, first + element.count, [&](int64_t, const char* p, const char* end, int64_t chunk) {
      FaceRow& row = scratch[size_t(chunk)];
      PlyFaceRows* const kept = keeps_rows ? &body.face_rows[base + size_t(chunk)] : nullptr;
      const auto refuse = [&](const std::string& what) { text.refuse(p, what); };
      const char* const stop = read_face(source, RowReader(text, element, p, end, long_rows[size_t(chunk)]), element,
                                         list, layout, kept, row);
      resize_counted(source, row.vertices, row.corners.size());
      add_ply_row(row.corners, is_strip, vertex_count, row.vertices, faces[base + size_t(chunk)], refuse);
      if (kept) add_face_row(source, row.vertices, row.lists, layout, *kept, refuse);
      return stop;
    });
  };
  // Vertices first, wherever they stand, since faces need them.
  for (const bool want_vertices : {true, false}) {
    first = 0;
    for (const PlyElement& element : header.elements) {
      if (&element == layout.vertices && want_vertices) read_vertices(element);
      if (&element == layout.faces && !want_vertices && row_count(element)) read_faces(element, layout.face_corners);
      if (&element == layout.strips && !want_vertices && row_count(element)) read_faces(element, layout.strip_corners);
      first += row_count(element);
    }
  }
  body.dirt.long_rows = std::accumulate(long_rows.begin(), long_rows.end(), int64_t(0));
}

}  // namespace isoshell
