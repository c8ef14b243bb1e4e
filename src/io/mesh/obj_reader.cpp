// OBJ: positions with their colours, faces with texture coordinates, normals, objects, groups and materials; everything
// else (smoothing groups, lines, curves) is passed over.
#include <algorithm>
#include <limits>
#include <unordered_map>

#include "io/bytes/mesh_source.h"
#include "io/faces/face_corners.h"
#include "io/mesh/obj_lines.h"
#include "isoshell/surface_source.h"

namespace isoshell {
namespace {

constexpr uint32_t kNoValue = 0xffffffff;
constexpr int64_t kBytesPerName = 256;  // of an object, group or material, beside four times its letters

/// Names that the faces of a chunk have: their objects, groups or materials.
struct ObjNames {
  const char* attribute;
  ObjLine line;
  std::vector<std::string> name = {};  ///< in the order of their first lines
  std::vector<uint32_t> of_face = {};  ///< kNoValue before the chunk's first line: that of the chunk before
  std::unordered_map<std::string, uint32_t> number = {};
  uint32_t now = kNoValue;

  void begin(const MeshSource& source, const std::string& text) {
    auto at = number.find(text);
    if (at == number.end()) {
      source.take(kBytesPerName + 4 * int64_t(text.size()));
      at = number.emplace(text, uint32_t(name.size())).first;
      name.push_back(text);
    }
    now = at->second;
  }
};

/// How many there are of what faces name.
struct ObjCounts {
  int64_t vertices = 0, textures = 0, normals = 0;

  void add(ObjLine line) {
    vertices += line == ObjLine::vertex;
    textures += line == ObjLine::texture;
    normals += line == ObjLine::normal;
  }
};
ObjCounts operator+(const ObjCounts& a, const ObjCounts& b) {
  return {a.vertices + b.vertices, a.textures + b.textures, a.normals + b.normals};
}

struct ObjChunk {
  TextChunk text;
  ObjCounts before = {}, here = {};
  int64_t faces = 0;
  bool has_names = false;
  std::vector<double> colors = {};  ///< three a vertex; empty where no vertex has one
  FaceCorners corners = {};
  std::vector<uint32_t> texture = {}, normal = {};  ///< per corner, if the file has some; kNoValue: it has none
  ObjNames names[3] = {
      {kObjectName, ObjLine::object}, {kGroupName, ObjLine::group}, {kMaterialName, ObjLine::material}};
  std::vector<std::string> libraries = {};
};

void count_lines(const MeshSource& source, ObjChunk& chunk) {
  const char* const end = chunk.text.end;
  for (const char* p = chunk.text.begin; p < end; p = line_end(p, end) + 1) {
    const ObjLine line = classify(p, end);
    chunk.here.add(line);
    chunk.faces += line == ObjLine::face;
    chunk.has_names |= line == ObjLine::object || line == ObjLine::group || line == ObjLine::material;
    if (line != ObjLine::library) continue;
    chunk.libraries.emplace_back(rest_of_line(p, end));
    source.take(kBytesPerName + 4 * int64_t(chunk.libraries.back().size()));
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

void read_vertices(const Text& text, ObjChunk& chunk, VertexTable& vertices) {
  WorldPoint* point = vertices.points.data() + chunk.before.vertices;
  const char* const end = chunk.text.end;
  const WorldPoint* const last = point + chunk.here.vertices;
  for (const char* p = chunk.text.begin; p < end && point < last; p = line_end(p, end) + 1) {
    if (classify(p, end) != ObjLine::vertex) continue;
    read_point(text, p, end, *point);
    double color[3];
    if (p = skip_blanks(p, end); p < end && *p != '\n' && parse_color(p, end, color)) {
      resize_counted(*vertices.source, chunk.colors, 3 * size_t(chunk.here.vertices), 1.0);
      std::copy(color, color + 3, &chunk.colors[3 * size_t(chunk.here.vertices - (last - point))]);
    }
    ++point;
  }
}

/// The values of one kind of lines, `components` a line; those that a line lacks at its end are 0, but for the first
/// `needed`.
void read_values(const Text& text, const ObjChunk& chunk, ObjLine kind, size_t needed, size_t components,
                 double* values) {
  const char* const end = chunk.text.end;
  for (const char* p = chunk.text.begin; p < end; p = line_end(p, end) + 1) {
    if (classify(p, end) != kind) continue;
    for (size_t i = 0; i < components; ++i) {
      p = skip_blanks(p, end);
      const bool is_there = parse_real(p, end, values[i]);
      if (!is_there && i < needed)
        text.refuse(p, std::string(kind == ObjLine::normal ? "a normal needs three numbers"
                                                           : "a texture coordinate needs a number") +
                           "; found " + quoted_token(p, end) + " instead of one");
      if (!is_there) values[i] = 0;
    }
    values += components;
  }
}

/// All chunks' in one; none where no vertex has one.
std::vector<Attribute> joined_colors(const MeshSource& source, std::vector<ObjChunk>& chunks, int64_t vertex_count) {
  if (std::all_of(chunks.begin(), chunks.end(), [](const ObjChunk& c) { return c.colors.empty(); })) return {};
  Attribute color{kColorName, NumberType::f32, 3, {}};
  resize_counted(source, color.values, 3 * size_t(vertex_count), 1.0);
  for (ObjChunk& chunk : chunks) {
    std::copy(chunk.colors.begin(), chunk.colors.end(), color.values.begin() + 3 * chunk.before.vertices);
    release(source, chunk.colors);
  }
  return {std::move(color)};
}

/// What is read of faces beside their vertices.
struct ObjWanted {
  bool textures, normals, names;
  bool any() const { return textures || normals || names; }
  bool corners() const { return textures || normals; }
};

constexpr ObjReference kVertex{"a face", "vertex", "vertices"}, kNormal{"a face", "normal", "normals"},
    kTexture{"a face", "texture coordinate", "texture coordinates"};

/// A number behind a slash, or none. False: something else stands there.
bool read_reference(const char*& p, const char* end, int64_t& index) {
  if (ends_token(p, end) || *p != '/') return true;
  ++p;
  return ends_token(p, end) || *p == '/' || parse_integer(p, end, index);
}

/// One corner, as i, i/t, i//n or i/t/n; p moves behind it.
class CornerReader {
 public:
  CornerReader(const MeshSource& source, const Text& text, const ObjCounts& all, const ObjWanted& wanted)
      : source_(source), text_(text), all_(all), wanted_(wanted) {}

  uint32_t read(const char*& p, const char* end, const ObjCounts& so_far, ObjChunk& to) const {
    const char* const token = p;
    int64_t index = 0;
    if (!parse_integer(p, end, index) || !(ends_token(p, end) || *p == '/'))
      text_.refuse(token, "a face corner is " + quoted_token(token, end) + "; it must begin with a vertex number");
    const uint32_t vertex = resolve(text_, token, kVertex, index, so_far.vertices, all_.vertices);
    if (wanted_.corners()) read_values(token, p, end, so_far, to);
    p = skip_token(p, end);
    return vertex;
  }

 private:
  void read_values(const char* token, const char*& p, const char* end, const ObjCounts& so_far, ObjChunk& to) const {
    constexpr int64_t kAbsent = std::numeric_limits<int64_t>::min();
    int64_t texture = kAbsent, normal = kAbsent;
    if (!read_reference(p, end, texture) || !read_reference(p, end, normal) || !ends_token(p, end))
      text_.refuse(token, "a face corner is " + quoted_token(token, end) +
                              "; numbers of a vertex, a texture coordinate and a normal may stand in it, as 1/2/3");
    if (wanted_.textures)
      keep(texture == kAbsent ? kNoValue : resolve(text_, token, kTexture, texture, so_far.textures, all_.textures),
           to.texture);
    if (wanted_.normals)
      keep(normal == kAbsent ? kNoValue : resolve(text_, token, kNormal, normal, so_far.normals, all_.normals),
           to.normal);
  }
  void keep(uint32_t value, std::vector<uint32_t>& of_corners) const {
    make_room(source_, of_corners, 1);
    of_corners.push_back(value);
  }

  const MeshSource& source_;
  const Text& text_;
  const ObjCounts& all_;
  const ObjWanted& wanted_;
};

void read_faces(const MeshSource& source, const Text& text, const ObjCounts& all, const ObjWanted& wanted,
                ObjChunk& chunk, FaceCollector& faces) {
  const char* const end = chunk.text.end;
  const CornerReader reader(source, text, all, wanted);
  ObjCounts so_far = chunk.before;
  int64_t left = chunk.faces;
  std::vector<uint32_t> corners;
  faces.reserve(chunk.faces);
  for (ObjNames& names : chunk.names)
    if (wanted.names) make_room(source, names.of_face, size_t(chunk.faces));
  for (const char* p = chunk.text.begin; p < end && (left > 0 || wanted.names); p = line_end(p, end) + 1) {
    const ObjLine line = classify(p, end);
    so_far.add(line);
    for (ObjNames& names : chunk.names)
      if (wanted.names && line == names.line) names.begin(source, std::string(rest_of_line(p, end)));
    if (line != ObjLine::face) continue;
    --left;
    corners.clear();
    for (p = skip_blanks(p, end); p < end && *p != '\n' && *p != '#'; p = skip_blanks(p, end)) {
      make_room(source, corners, 1);
      corners.push_back(reader.read(p, end, so_far, chunk));
    }
    faces.add_polygon(corners.data(), int64_t(corners.size()));
    if (wanted.corners()) {
      make_room(source, chunk.corners.vertex, corners.size());
      make_room(source, chunk.corners.first, 1);
      chunk.corners.vertex.insert(chunk.corners.vertex.end(), corners.begin(), corners.end());
      chunk.corners.end_face();
    }
    for (ObjNames& names : chunk.names)
      if (wanted.names) names.of_face.push_back(names.now);
  }
}

/// Values of corners, by the numbers that `of_corner` of each chunk has for its corners.
void add_corner_attribute(const MeshSource& source, const std::vector<ObjChunk>& chunks,
                          const std::vector<FaceCollector>& faces, std::vector<uint32_t> ObjChunk::*of_corner,
                          Attribute attribute, TriangleSoup& soup) {
  const auto none = uint32_t(attribute.values.size() / size_t(attribute.components));
  resize_counted(source, attribute.values, attribute.values.size() + size_t(attribute.components),
                 std::numeric_limits<double>::quiet_NaN());
  attribute.domain = AttributeDomain::corner;
  resize_counted(source, attribute.index, 3 * soup.triangles.size());
  const std::vector<size_t> first = triangles_first(faces);
  for_each_chunk(int64_t(chunks.size()), [&](int64_t c) {
    const ObjChunk& chunk = chunks[size_t(c)];
    const std::vector<uint32_t>& face_of = faces[size_t(c)].face_of();
    CornerFinder corners(chunk.corners);
    for (size_t t = 0; t < face_of.size(); ++t)
      corners.find(face_of[t], soup.triangles[first[size_t(c)] + t], [&](size_t i, size_t corner) {
        const uint32_t value = (chunk.*of_corner)[corner];
        attribute.index[3 * (first[size_t(c)] + t) + i] = value == kNoValue ? none : value;
      });
  });
  const bool is_used =
      std::any_of(attribute.index.begin(), attribute.index.end(), [&](uint32_t i) { return i != none; });
  if (is_used) soup.attributes.push_back(std::move(attribute));
}

/// One of the three kinds of names, of all chunks. None where no line gives one.
void add_names(const MeshSource& source, const std::vector<ObjChunk>& chunks, const std::vector<FaceCollector>& faces,
               size_t kind, TriangleSoup& soup) {
  Attribute attribute{chunks[0].names[kind].attribute, NumberType::i32, 1, {}, AttributeDomain::face};
  make_room(source, attribute.values, soup.triangles.size());
  std::unordered_map<std::string, double> number = {{"", -1}};
  double now = -1;
  for (size_t c = 0; c < chunks.size(); ++c) {
    const ObjNames& names = chunks[c].names[kind];
    std::vector<double> of_name;
    for (const std::string& name : names.name) {
      const auto [at, is_new] = number.emplace(name, double(attribute.labels.size()));
      if (is_new) attribute.labels.push_back(name);
      of_name.push_back(at->second);
    }
    for (const uint32_t face : faces[c].face_of()) {
      const uint32_t name = names.of_face[face];
      attribute.values.push_back(name == kNoValue ? now : of_name[name]);
    }
    if (names.now != kNoValue) now = of_name[names.now];
  }
  if (!attribute.labels.empty()) soup.attributes.push_back(std::move(attribute));
}

}  // namespace

TriangleSoup read_obj(const MeshSource& source) {
  const Text text(source, Text::Continuation::backslash);
  std::vector<ObjChunk> chunks;
  for (const TextChunk& piece : split_at_lines(text.begin(), text.end())) chunks.push_back({piece});
  const int64_t chunk_count = int64_t(chunks.size());
  for_each_chunk(chunk_count, [&](int64_t c) { count_lines(source, chunks[size_t(c)]); });
  ObjCounts all;
  ObjWanted wanted{false, false, false};
  for (ObjChunk& chunk : chunks) {
    chunk.before = all;
    all = all + chunk.here;
    wanted.names |= chunk.has_names;
  }
  wanted.textures = all.textures > 0;
  wanted.normals = all.normals > 0;

  if (std::max(all.textures, all.normals) > kMaxSoupVertices)
    source.refuse("holds more than " + std::to_string(kMaxSoupVertices) +
                  " texture coordinates or normals, the most that can be read; split the file");
  VertexTable vertices(source, all.vertices);
  Attribute uv{kUvName, NumberType::f32, 2, {}}, normal{kNormalName, NumberType::f32, 3, {}};
  make_room(source, uv.values, 2 * size_t(all.textures) + 2);  // and one more, of corners that have none
  make_room(source, normal.values, 3 * size_t(all.normals) + 3);
  uv.values.resize(2 * size_t(all.textures));
  normal.values.resize(3 * size_t(all.normals));
  for_each_chunk(chunk_count, [&](int64_t c) {
    ObjChunk& chunk = chunks[size_t(c)];
    read_vertices(text, chunk, vertices);
    if (wanted.textures) read_values(text, chunk, ObjLine::texture, 1, 2, uv.values.data() + 2 * chunk.before.textures);
    if (wanted.normals)
      read_values(text, chunk, ObjLine::normal, 3, 3, normal.values.data() + 3 * chunk.before.normals);
  });
  vertices.count_nonfinite();
  const auto keep = wanted.any() ? FaceCollector::Keep::faces_too : FaceCollector::Keep::triangles;
  std::vector<FaceCollector> faces(chunks.size(), FaceCollector(vertices, keep));
  for_each_chunk(chunk_count,
                 [&](int64_t c) { read_faces(source, text, all, wanted, chunks[size_t(c)], faces[size_t(c)]); });
  TriangleSoup soup = join_soup(source, std::move(vertices), faces);
  soup.attributes = joined_colors(source, chunks, all.vertices);
  if (wanted.textures) add_corner_attribute(source, chunks, faces, &ObjChunk::texture, std::move(uv), soup);
  if (wanted.normals) add_corner_attribute(source, chunks, faces, &ObjChunk::normal, std::move(normal), soup);
  for (size_t kind = 0; wanted.names && kind < 3; ++kind) add_names(source, chunks, faces, kind, soup);
  for (ObjChunk& chunk : chunks)
    soup.files.materials.insert(soup.files.materials.end(), chunk.libraries.begin(), chunk.libraries.end());
  return soup;
}

}  // namespace isoshell
