// read_polylines (see polyline_file.h): the lines of OBJ, the edges of PLY.
#include "isoshell/io/polyline_file.h"

#include <cmath>
#include <unordered_set>

#include "core/file_format.h"
#include "geometry/half_edges.h"
#include "io/mesh/obj_lines.h"
#include "io/ply/ply_body.h"
#include "io/polyline_readers.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

/// Takes segments, and leaves out those that join nothing or are there.
class SegmentCollector {
 public:
  SegmentCollector(const MeshSource& source, Polylines& lines) : source_(source), lines_(lines) {}

  void add(uint32_t from, uint32_t to, int64_t line) {
    if (from == to || known_.count(edge_key(from, to)) > 0) return;
    source_.take(kKnownBytes);
    known_.insert(edge_key(from, to));
    make_room(source_, lines_.segments, 1);
    make_room(source_, lines_.lines, 1);
    lines_.segments.push_back({from, to});
    lines_.lines.push_back(line);
  }

 private:
  static constexpr int64_t kKnownBytes = 48;  ///< an element of the set

  const MeshSource& source_;
  Polylines& lines_;
  std::unordered_set<uint64_t> known_;
};

WorldPoint read_point(const Text& text, const char* p, const char* end) {
  WorldPoint point{};
  for (double* value : {&point.x, &point.y, &point.z}) {
    p = skip_blanks(p, end);
    const char* const token = p;
    if (!parse_real(p, end, *value) || !std::isfinite(*value))
      text.refuse(token, "a vertex needs three finite numbers; found " + quoted_token(token, end) + " instead of one");
  }
  return point;
}

/// The vertices of one line, as 7 or 7/2, from 1 on or, when negative, back from the last one.
std::vector<uint32_t> read_line(const MeshSource& source, const Text& text, const char* p, const char* end,
                                int64_t so_far, int64_t count) {
  std::vector<uint32_t> vertices;
  for (p = skip_blanks(p, end); p < end && *p != '\n' && *p != '#'; p = skip_blanks(p, end)) {
    const char* const token = p;
    int64_t index = 0;
    if (!parse_integer(p, end, index) || !(ends_token(p, end) || *p == '/'))
      text.refuse(token, "a line names the vertex " + quoted_token(token, end) + "; give its number");
    make_room(source, vertices, 1);
    vertices.push_back(resolve(text, token, {"a line", "vertex", "vertices"}, index, so_far, count));
    p = skip_token(p, end);
  }
  if (vertices.size() < 2) text.refuse(p, "a line has fewer than two vertices; give two or more");
  return vertices;
}

Polylines parse_obj(const MeshSource& source) {
  Polylines lines;
  const Text text(source, Text::Continuation::backslash);
  const char* const end = text.end();
  const auto each_line = [&](auto read) {
    int64_t number = 1;
    for (const char* p = text.begin(); p < end; p = line_end(p, end) + 1, ++number) {
      const char* behind = p;
      const ObjLine kind = classify(behind, end);
      read(kind, behind, number);
    }
  };
  each_line([&](ObjLine kind, const char* p, int64_t) {
    if (kind != ObjLine::vertex) return;
    make_room(source, lines.points, 1);
    lines.points.push_back(read_point(text, p, end));
  });
  SegmentCollector segments(source, lines);
  int64_t so_far = 0;
  each_line([&](ObjLine kind, const char* p, int64_t number) {
    so_far += kind == ObjLine::vertex;
    if (kind != ObjLine::line) return;
    const std::vector<uint32_t> along = read_line(source, text, p, end, so_far, int64_t(lines.points.size()));
    for (size_t i = 0; i + 1 < along.size(); ++i) segments.add(along[i], along[i + 1], number);
  });
  return lines;
}

/// Numbers of an element, which are read as if they were positions.
std::vector<WorldPoint> read_numbers(const MeshSource& source, const PlyHeader& header, const char* element,
                                     const std::array<const char*, 3>& names) {
  PlyMeshLayout layout;
  layout.vertices = header.find(element);
  if (!layout.vertices) return {};
  for (size_t i = 0; i < 3; ++i) {
    layout.xyz[i] = layout.vertices->find(names[i]);
    if (layout.xyz[i] < 0 || layout.vertices->properties[size_t(layout.xyz[i])].is_list)
      source.refuse_line_at(layout.vertices->header_line,
                            std::string("element ") + element + " has no number named " + names[i]);
  }
  PlyBody body(source);
  read_ply_body(source, header, layout, body);
  return std::move(body.vertices.points);
}

/// Whole numbers without a point.
std::string number_text(double value) {
  const bool is_whole = value == std::floor(value) && std::abs(value) < 1e15;
  return is_whole ? std::to_string(int64_t(value)) : std::to_string(value);
}

Polylines parse_ply(const MeshSource& source) {
  Polylines lines;
  const PlyHeader header = read_ply_header(source);
  lines.points = read_numbers(source, header, "vertex", {"x", "y", "z"});
  const std::vector<WorldPoint> ends = read_numbers(source, header, "edge", {"vertex1", "vertex2", "vertex2"});
  SegmentCollector segments(source, lines);
  for (size_t e = 0; e < ends.size(); ++e) {
    uint32_t vertex[2];
    const double index[2] = {ends[e].x, ends[e].y};
    for (size_t i = 0; i < 2; ++i) {
      const bool is_there = index[i] >= 0 && index[i] < double(lines.points.size()) && index[i] == std::floor(index[i]);
      if (!is_there)
        source.refuse(no_such_vertex("edge " + std::to_string(e), number_text(index[i]), int64_t(lines.points.size())));
      vertex[i] = uint32_t(index[i]);
      const WorldPoint& p = lines.points[vertex[i]];
      if (!is_finite(p))
        source.refuse("vertex " + std::to_string(vertex[i]) + " of edge " + std::to_string(e) +
                      " is not finite; correct it or leave the edge out");
    }
    segments.add(vertex[0], vertex[1], 0);
  }
  lines.lines.clear();  // rows are no lines of the file
  return lines;
}

}  // namespace

Polylines read_obj_lines(const MeshSource& source) {
  Polylines lines = parse_obj(source);
  if (lines.segments.empty()) source.refuse("holds no line of two vertices; lines begin with l, as l 1 2 3");
  lines.source = source.name();
  return lines;
}

Polylines read_ply_edges(const MeshSource& source) {
  Polylines lines = parse_ply(source);
  if (lines.segments.empty()) source.refuse("holds no edges; they are an element edge with vertex1 and vertex2");
  lines.source = source.name();
  return lines;
}

std::shared_ptr<const Polylines> read_polylines(const std::string& path, int64_t memory_limit_bytes) {
  const std::string format = format_of_path(path);
  if (format != "obj" && format != "ply")
    throw Error(ErrorCode::usage, "features",
                path + ": lines are read from OBJ and PLY files; give a name that ends in .obj or .ply");
  ReadingBudget budget(memory_limit_bytes);
  const MeshSource source(path, budget);
  return std::make_shared<Polylines>(format == "obj" ? read_obj_lines(source) : read_ply_edges(source));
}

}  // namespace isoshell
