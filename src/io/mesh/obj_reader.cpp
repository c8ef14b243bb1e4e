// OBJ: positions with their colours, and faces; everything else (normals, groups, lines, curves) is passed over.
#include <algorithm>

#include "io/mesh/face_collector.h"
#include "io/mesh/mesh_readers.h"
#include "io/text_scan.h"

namespace isoshell {
namespace {

struct ObjChunk {
  TextChunk text;
  int64_t first_vertex = 0, vertices = 0, faces = 0;
  std::vector<double> colors = {};  ///< three a vertex; empty where no vertex has one
};

enum class ObjLine { other, vertex, face };

// What the line at p holds; p moves behind the keyword.
ObjLine classify(const char*& p, const char* end) {
  p = skip_blanks(p, end);
  if (p == end || !ends_token(p + 1, end)) return ObjLine::other;
  const char keyword = *p;
  ++p;
  return keyword == 'v' ? ObjLine::vertex : keyword == 'f' ? ObjLine::face : ObjLine::other;
}

void count_lines(ObjChunk& chunk) {
  const char* const end = chunk.text.end;
  for (const char* p = chunk.text.begin; p < end; p = line_end(p, end) + 1) {
    const ObjLine line = classify(p, end);
    chunk.vertices += line == ObjLine::vertex;
    chunk.faces += line == ObjLine::face;
  }
}

/// Three numbers up to the end of the line, and no fourth: one more than a position has would be its weight.
bool parse_color(const char* p, const char* end, double color[3]) {
  for (int i = 0; i < 3; ++i) {
    p = skip_blanks(p, end);
    if (!parse_real(p, end, color[i])) return false;
  }
  p = skip_blanks(p, end);
  return p == end || *p == '\n' || *p == '#';
}

void read_vertices(const Text& text, ObjChunk& chunk, std::vector<WorldPoint>& points) {
  WorldPoint* point = points.data() + chunk.first_vertex;
  const char* const end = chunk.text.end;
  const WorldPoint* const last = point + chunk.vertices;
  for (const char* p = chunk.text.begin; p < end && point < last; p = line_end(p, end) + 1) {
    if (classify(p, end) != ObjLine::vertex) continue;
    for (double* value : {&point->x, &point->y, &point->z}) {
      p = skip_blanks(p, end);
      if (!parse_real(p, end, *value))
        text.refuse(p, "a vertex needs three numbers; found " + quoted_token(p, end) + " instead of one");
    }
    double color[3];
    if (p = skip_blanks(p, end); p < end && *p != '\n' && parse_color(p, end, color)) {
      chunk.colors.resize(3 * size_t(chunk.vertices), 1);
      std::copy(color, color + 3, &chunk.colors[3 * size_t(chunk.vertices - (last - point))]);
    }
    ++point;
  }
}

/// All chunks' in one; none where no vertex has one.
std::vector<VertexAttribute> joined_colors(std::vector<ObjChunk>& chunks, int64_t vertex_count) {
  if (std::all_of(chunks.begin(), chunks.end(), [](const ObjChunk& c) { return c.colors.empty(); })) return {};
  VertexAttribute color{kColorName, NumberType::f32, 3, std::vector<double>(3 * size_t(vertex_count), 1)};
  for (ObjChunk& chunk : chunks) {
    std::copy(chunk.colors.begin(), chunk.colors.end(), color.values.begin() + 3 * chunk.first_vertex);
    chunk.colors = {};
  }
  return {std::move(color)};
}

// One corner, as i, i/t, i//n or i/t/n; relative when negative. Returns a 0-based index.
uint32_t read_corner(const Text& text, const char*& p, const char* end, int64_t vertices_so_far, int64_t vertex_count) {
  const char* const token = p;
  int64_t index = 0;
  if (!parse_integer(p, end, index) || !(ends_token(p, end) || *p == '/'))
    text.refuse(token, "a face corner is " + quoted_token(token, end) + "; it must begin with a vertex number");
  p = skip_token(p, end);
  const int64_t vertex = index < 0 ? vertices_so_far + index : index - 1;
  if (index == 0 || vertex < 0 || vertex >= vertex_count)
    text.refuse(token, "a face names vertex " + std::to_string(index) + "; " +
                           (index < 0 ? std::to_string(vertices_so_far) + " vertices come before it, so -1 to -" +
                                            std::to_string(vertices_so_far)
                                      : "the file holds vertices 1 to " + std::to_string(vertex_count)) +
                           "; correct the index or restore the missing vertices");
  return uint32_t(vertex);
}

void read_faces(const Text& text, const ObjChunk& chunk, int64_t vertex_count, FaceCollector& faces) {
  const char* const end = chunk.text.end;
  int64_t vertices_so_far = chunk.first_vertex, left = chunk.faces;
  std::vector<uint32_t> corners;
  faces.reserve(chunk.faces);
  for (const char* p = chunk.text.begin; p < end && left > 0; p = line_end(p, end) + 1) {
    const ObjLine line = classify(p, end);
    vertices_so_far += line == ObjLine::vertex;
    if (line != ObjLine::face) continue;
    --left;
    corners.clear();
    for (p = skip_blanks(p, end); p < end && *p != '\n' && *p != '#'; p = skip_blanks(p, end))
      corners.push_back(read_corner(text, p, end, vertices_so_far, vertex_count));
    faces.add_polygon(corners.data(), int64_t(corners.size()));
  }
}

}  // namespace

TriangleSoup read_obj(const MeshSource& source) {
  const Text text(source, Text::Continuation::backslash);
  std::vector<ObjChunk> chunks;
  for (const TextChunk& piece : split_at_lines(text.begin(), text.end())) chunks.push_back({piece});
  const int64_t chunk_count = int64_t(chunks.size());
  for_each_chunk(chunk_count, [&](int64_t c) { count_lines(chunks[size_t(c)]); });
  int64_t vertex_count = 0;
  for (ObjChunk& chunk : chunks) {
    chunk.first_vertex = vertex_count;
    vertex_count += chunk.vertices;
  }

  VertexTable vertices(source, vertex_count);
  for_each_chunk(chunk_count, [&](int64_t c) { read_vertices(text, chunks[size_t(c)], vertices.points); });
  vertices.count_nonfinite();
  std::vector<FaceCollector> faces(chunks.size(), FaceCollector(vertices));
  for_each_chunk(chunk_count, [&](int64_t c) { read_faces(text, chunks[size_t(c)], vertex_count, faces[size_t(c)]); });
  TriangleSoup soup = join_soup(source, std::move(vertices), faces);
  soup.attributes = joined_colors(chunks, vertex_count);
  return soup;
}

}  // namespace isoshell
