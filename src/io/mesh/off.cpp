// OFF as text: a row of counts, a row a vertex, a row a face. Normals and colours are passed over.
#include <algorithm>

#include "io/bytes/mesh_source.h"
#include "io/bytes/output_file.h"
#include "io/bytes/row_buffer.h"
#include "io/bytes/text_scan.h"
#include "io/faces/face_collector.h"
#include "io/mesh/precision.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/surface_source.h"

namespace isoshell {
namespace {

void put_text(RowBuffer& out, const std::array<uint32_t, 3>& t) {
  for (int i = 0; i < 3; ++i) {
    out.put_number(t[size_t(i)]);
    out.put(i < 2 ? ' ' : '\n');
  }
}

struct OffHeader {
  int64_t vertices = 0, faces = 0;
  const char* body = nullptr;
};

// Blanks, line breaks and comments.
const char* skip_space(const char* p, const char* end) {
  for (;;) {
    while (p < end && (is_blank(*p) || *p == '\n')) ++p;
    if (p == end || *p != '#') return p;
    p = line_end(p, end);
  }
}

// [ST][C][N]OFF; counts may follow at once.
const char* read_keyword(const Text& text, const char* p) {
  const char* const end = text.end();
  const char* const token = p;
  const auto starts_with = [&](const char* word) {
    const size_t length = std::strlen(word);
    return size_t(end - p) >= length && std::equal(word, word + length, p);
  };
  if (starts_with("ST")) p += 2;
  if (starts_with("C")) ++p;
  if (starts_with("N")) ++p;
  if (starts_with("4") || starts_with("n"))
    text.refuse(token, "this is " + quoted_token(token, end) + "; only three-dimensional OFF can be read");
  if (!starts_with("OFF"))
    text.refuse(token, "the file begins with " + quoted_token(token, end) + "; an OFF file begins with OFF");
  p += 3;
  if (!ends_token(p, end) && !is_digit(*p) && *p != '#')
    text.refuse(token, "the file begins with " + quoted_token(token, end) + "; an OFF file begins with OFF");
  const char* const next = skip_space(p, end);
  if (end - next >= 6 && std::equal(next, next + 6, "BINARY"))
    text.refuse(next, "binary OFF cannot be read; write it as text, or as PLY");
  return next;
}

OffHeader read_header(const Text& text) {
  const char* const end = text.end();
  const char* p = read_keyword(text, skip_space(text.begin(), end));
  const char* const counts = p;
  OffHeader header;
  int64_t edges = 0;
  for (int64_t* count : {&header.vertices, &header.faces, &edges}) {
    p = skip_blanks(p, end);
    const bool absent = p == end || *p == '\n' || *p == '#';
    if (count == &edges && absent) break;
    const char* const token = p;
    if (!parse_integer(p, end, *count) || *count < 0 || !(ends_token(p, end) || *p == '#'))
      text.refuse(token, "the counts of vertices, faces and edges are expected; found " + quoted_token(token, end));
  }
  // Every vertex takes at least six bytes ("0 0 0\n") and every face two; the last line break may be missing.
  const int64_t room = end - p + 1;
  if (header.vertices > room / 6 || header.faces > (room - 6 * header.vertices) / 2)
    text.refuse(counts, "the header promises " + std::to_string(header.vertices) + " vertices and " +
                            std::to_string(header.faces) + " faces; the " + std::to_string(end - p) +
                            " bytes that follow cannot hold them; correct the counts or restore the file");
  header.body = std::min(end, line_end(p, end) + 1);
  return header;
}

// "n i1 ... in", then perhaps a colour.
const char* read_face(const MeshSource& source, const Text& text, const char* p, const char* end, int64_t vertex_count,
                      std::vector<uint32_t>& corners) {
  int64_t count = 0;
  const char* token = p;
  if (!parse_integer(p, end, count) || count < 0 || !ends_token(p, end))
    text.refuse(token, "a face begins with its number of corners; found " + quoted_token(token, end));
  corners.clear();
  for (int64_t i = 0; i < count; ++i) {
    token = p = skip_blanks(p, end);
    int64_t index = 0;
    if (!parse_integer(p, end, index) || !ends_token(p, end))
      text.refuse(token, "the face promises " + std::to_string(count) + " corners; corner " + std::to_string(i + 1) +
                             " is " + quoted_token(token, end));
    if (index < 0 || index >= vertex_count)
      text.refuse(token, no_such_vertex("a face", std::to_string(index), vertex_count));
    make_room(source, corners, 1);
    corners.push_back(uint32_t(index));
  }
  return p;
}

}  // namespace

TriangleSoup read_off(const MeshSource& source) {
  const Text text(source);
  const OffHeader header = read_header(text);
  const TextRows rows(text, header.body, '#');
  if (rows.count() != header.vertices + header.faces)
    text.refuse(rows.find(header.vertices + header.faces),
                "the header promises " + std::to_string(header.vertices) + " vertices and " +
                    std::to_string(header.faces) + " faces, a row each; the file holds " +
                    std::to_string(rows.count()) + " rows; correct the counts or restore the file");

  VertexTable vertices(source, header.vertices);
  rows.for_each(0, header.vertices, [&](int64_t row, const char* p, const char* end, int64_t) {
    read_point(text, p, end, vertices.points[size_t(row)]);
    return p;
  });
  vertices.count_nonfinite();
  std::vector<FaceCollector> faces(size_t(rows.chunk_count()), FaceCollector(vertices));
  std::vector<std::vector<uint32_t>> corners(faces.size());
  rows.for_each(header.vertices, rows.count(), [&](int64_t, const char* p, const char* end, int64_t chunk) {
    p = read_face(source, text, p, end, header.vertices, corners[size_t(chunk)]);
    faces[size_t(chunk)].add_polygon(corners[size_t(chunk)].data(), int64_t(corners[size_t(chunk)].size()));
    return p;
  });
  return join_soup(source, std::move(vertices), faces);
}

void write_off(OutputFile& file, const TriangleMesh& mesh, const Placement& placement, const MeshWriteOptions&) {
  const std::string note = offset_note(placement);
  file.write("OFF\n" + (note.empty() ? "" : "# " + note + "\n") + std::to_string(mesh.vertices.size()) + " " +
             std::to_string(mesh.triangles.size()) + " 0\n");
  write_rows(file, int64_t(mesh.vertices.size()), 3 * (kLongestDouble + 1), [&](int64_t i, RowBuffer& out) {
    put_text(out, placement.written(mesh.vertices[size_t(i)]));
    out.put('\n');
  });
  write_rows(file, int64_t(mesh.triangles.size()), 2 + 3 * (kLongestIndex + 1), [&](int64_t i, RowBuffer& out) {
    out.put('3');
    out.put(' ');
    put_text(out, mesh.triangles[size_t(i)]);
  });
}

}  // namespace isoshell
