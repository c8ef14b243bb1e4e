// STL, binary and text. Normals are passed over; corners are welded by position. The solids of a text file are groups.
#include <algorithm>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <utility>

#include "geometry/world_vector.h"
#include "io/bytes/byte_order.h"
#include "io/bytes/mesh_source.h"
#include "io/bytes/output_file.h"
#include "io/bytes/row_buffer.h"
#include "io/bytes/text_scan.h"
#include "io/faces/face_collector.h"
#include "io/faces/face_corners.h"
#include "io/faces/weld.h"
#include "io/mesh/precision.h"
#include "isoshell/error.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/surface_source.h"

namespace isoshell {
namespace {

// Unit normal; zero where the triangle has no area.
WorldPoint normal_of(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const WorldPoint n = doubled_area(a, b, c);
  const double size = length(n);
  if (!(size > 0) || !std::isfinite(size)) return {0, 0, 0};
  return {n.x / size, n.y / size, n.z / size};
}

constexpr int64_t kHeaderBytes = 80, kCountBytes = 4, kFacetBytes = 50;

// The word at p in lower-case letters equals `word`; then p moves behind it.
bool take_word(const char*& p, const char* end, const char* word) {
  p = skip_blanks(p, end);
  const char* s = p;
  for (; *word; ++word, ++s)
    if (s == end || (*s | 0x20) != *word) return false;
  if (!ends_token(s, end)) return false;
  p = s;
  return true;
}

bool is_binary(const MeshSource& source) {
  const char* p = source.begin();
  const int64_t size = source.size();
  if (size >= kHeaderBytes + kCountBytes &&
      size == kHeaderBytes + kCountBytes + kFacetBytes * int64_t(load_little_endian<uint32_t>(p + kHeaderBytes)))
    return true;
  while (p < source.end() && (is_blank(*p) || *p == '\n')) ++p;
  return !take_word(p, source.end(), "solid") || std::memchr(p, '\0', size_t(std::min<int64_t>(512, source.end() - p)));
}

TriangleSoup read_binary(const MeshSource& source) {
  if (source.size() < kHeaderBytes + kCountBytes)
    source.refuse("is " + std::to_string(source.size()) +
                  " bytes long; a binary STL has at least 84 and a text STL "
                  "begins with solid; restore the file");
  const int64_t count = load_little_endian<uint32_t>(source.begin() + kHeaderBytes);
  const int64_t body = source.size() - kHeaderBytes - kCountBytes;
  if (body < kFacetBytes * count || body >= kFacetBytes * (count + 1))
    source.refuse_byte(kHeaderBytes, "the header promises " + std::to_string(count) + " facets of 50 bytes; " +
                                         std::to_string(body) + " bytes follow, room for " +
                                         std::to_string(body / kFacetBytes) +
                                         "; the file is truncated or its count is wrong");
  const BinaryStlCorners corners{source.begin() + kHeaderBytes + kCountBytes};
  WeldedCorners welded = weld_corners(source, 3 * count, corners);
  std::vector<FaceCollector> faces(1, FaceCollector(welded.vertices));
  faces[0].adopt(std::move(welded.index));
  return join_soup(source, std::move(welded.vertices), faces);
}

// From this facet on they are of another solid, or of none.
struct SolidStart {
  size_t facet;           // of the chunk
  std::string_view name;  // empty: none
  double number = -1;     // of the name, among those of all chunks
};

struct TextFacets {
  TextChunk text{};
  std::vector<WorldPoint> corners;
  std::vector<uint32_t> corner_counts;  // of each facet
  std::vector<SolidStart> solids;       // before the first one, the last one of the chunk before goes on
  int64_t first_corner = 0;
  double number_before = -1;  // of the name of these facets
};

// Reads facets until the end of the chunk; all lines between facets but solid and endsolid are refused.
class FacetReader {
 public:
  FacetReader(const MeshSource& source, const Text& text, TextFacets& out)
      : source_(source), text_(text), out_(out), end_(out.text.end) {}

  void read() {
    const char* p = out_.text.begin;
    for (; p < end_; p = line_end(p, end_) + 1) {
      p = skip_blanks(p, end_);
      if (p == end_ || *p == '\n') continue;
      read_line(p);
    }
    if (in_facet_)
      text_.refuse(
          end_, "the facet before this place is not closed by endfacet; the file is truncated or damaged, restore it");
  }

 private:
  void read_line(const char*& p) {
    const char* const token = p;
    if (take_word(p, end_, "vertex")) {
      if (!in_loop_) text_.refuse(token, "a vertex stands outside a loop");
      read_vertex(p);
    } else if (take_word(p, end_, "facet")) {
      if (in_facet_) text_.refuse(token, "a facet begins inside a facet; an endfacet is missing");
      in_facet_ = true;
      make_room(source_, out_.corner_counts, 1);
      out_.corner_counts.push_back(0);
    } else if (take_word(p, end_, "outer")) {
      if (!in_facet_ || in_loop_ || out_.corner_counts.back() > 0) text_.refuse(token, "a loop stands outside a facet");
      in_loop_ = true;
    } else if (take_word(p, end_, "endloop")) {
      if (!in_loop_) text_.refuse(token, "endloop closes no loop");
      in_loop_ = false;
    } else if (take_word(p, end_, "endfacet")) {
      if (!in_facet_ || in_loop_) text_.refuse(token, "endfacet closes no facet");
      in_facet_ = false;
    } else if (!in_facet_ && take_word(p, end_, "solid")) {
      begin_solid(rest_of_line(p, end_));
    } else if (!in_facet_ && take_word(p, end_, "endsolid")) {
      begin_solid({});
    } else {
      text_.refuse(token, quoted_token(token, end_) + " is no word of a text STL at this place");
    }
  }

  void begin_solid(std::string_view name) {
    const size_t facet = out_.corner_counts.size();
    if (out_.solids.empty() || out_.solids.back().facet < facet) {
      make_room(source_, out_.solids, 1);
      out_.solids.push_back({facet, name});
    }
    out_.solids.back().name = name;
  }

  void read_vertex(const char*& p) {
    WorldPoint point;
    read_point(text_, p, end_, point);
    make_room(source_, out_.corners, 1);
    out_.corners.push_back(point);
    ++out_.corner_counts.back();
  }

  const MeshSource& source_;
  const Text& text_;
  TextFacets& out_;
  const char* end_;
  bool in_facet_ = false, in_loop_ = false;
};

// Chunks that begin at a facet.
std::vector<TextFacets> split_at_facets(const Text& text) {
  std::vector<TextFacets> parts;
  for (const TextChunk& chunk : split_at_lines(text.begin(), text.end())) {
    const char* p = chunk.begin;
    for (const char* word = p; p < chunk.end && !take_word(word, chunk.end, "facet"); word = p)
      p = std::min(chunk.end, line_end(p, chunk.end) + 1);
    if (parts.empty()) {
      parts.emplace_back().text = chunk;
    } else if (p == chunk.end) {
      parts.back().text.end = chunk.end;
    } else {
      parts.back().text.end = p;
      parts.emplace_back().text = {p, chunk.end};
    }
  }
  return parts;
}

// A file cut at the end of a facet would look whole without this.
void require_endsolid(const Text& text) {
  const char* p = text.end();
  while (p > text.begin() && (is_blank(p[-1]) || p[-1] == '\n')) --p;
  const char* const last = p;
  while (p > text.begin() && p[-1] != '\n') --p;
  if (const char* word = p; !take_word(word, last, "endsolid"))
    text.refuse(p, "the file ends without endsolid; it is truncated, restore it");
}

constexpr int64_t kBytesPerName = 256;  // of a solid, beside four times its letters

// Numbers the names of solids, each once, in the order of their first facets. None where all facets are of one.
std::vector<std::string> number_solids(const MeshSource& source, std::vector<TextFacets>& parts) {
  std::vector<std::string> names;
  std::unordered_map<std::string_view, double> number = {{"", -1}};
  double now = -1;
  bool has_unnamed = false;
  const auto begin = [&](std::string_view name) {
    const auto [at, is_new] = number.emplace(name, double(names.size()));
    if (is_new) {
      source.take(kBytesPerName + 4 * int64_t(name.size()));
      names.emplace_back(name);
    }
    has_unnamed |= name.empty();
    return now = at->second;
  };
  std::optional<std::string_view> waiting;  // for a facet, wherever the chunk ends
  for (TextFacets& part : parts) {
    const bool goes_on = !part.corner_counts.empty() && (part.solids.empty() || part.solids.front().facet > 0);
    if (goes_on && waiting) begin(*std::exchange(waiting, {}));
    part.number_before = now;
    for (SolidStart& solid : part.solids) {
      waiting.reset();
      if (solid.facet == part.corner_counts.size())
        waiting = solid.name;
      else
        solid.number = begin(solid.name);
    }
  }
  if (names.size() + size_t(has_unnamed) < 2) names.clear();
  return names;
}

// The names as groups of the triangles.
Attribute groups_of_solids(const MeshSource& source, std::vector<std::string> names,
                           const std::vector<TextFacets>& parts, const std::vector<FaceCollector>& faces) {
  Attribute group{kGroupName, NumberType::i32, 1, {}, AttributeDomain::face, {}, std::move(names)};
  const std::vector<size_t> first = triangles_first(faces);
  resize_counted(source, group.values, first.back());
  for_each_chunk(int64_t(parts.size()), [&](int64_t i) {
    const TextFacets& part = parts[size_t(i)];
    double* value = group.values.data() + first[size_t(i)];
    double now = part.number_before;
    auto next = part.solids.begin();
    for (const uint32_t facet : faces[size_t(i)].face_of()) {
      for (; next != part.solids.end() && next->facet <= facet; ++next) now = next->number;
      *value++ = now;
    }
  });
  return group;
}

TriangleSoup read_text(const MeshSource& source) {
  const Text text(source);
  require_endsolid(text);
  std::vector<TextFacets> parts = split_at_facets(text);
  const int64_t part_count = int64_t(parts.size());
  for_each_chunk(part_count, [&](int64_t i) { FacetReader(source, text, parts[size_t(i)]).read(); });
  int64_t corner_count = 0;
  for (TextFacets& part : parts) {
    part.first_corner = corner_count;
    corner_count += int64_t(part.corners.size());
  }
  std::vector<WorldPoint> corners;
  resize_counted(source, corners, size_t(corner_count));
  for_each_chunk(part_count, [&](int64_t i) {
    TextFacets& part = parts[size_t(i)];
    std::copy(part.corners.begin(), part.corners.end(), corners.begin() + part.first_corner);
    release(source, part.corners);
  });
  WeldedCorners welded = weld_corners(source, corner_count, CornerArray{corners.data()});
  std::vector<std::string> solids = number_solids(source, parts);
  const auto keep = solids.empty() ? FaceCollector::Keep::triangles : FaceCollector::Keep::faces_too;
  std::vector<FaceCollector> faces(parts.size(), FaceCollector(welded.vertices, keep));
  for_each_chunk(part_count, [&](int64_t i) {
    const uint32_t* at = reinterpret_cast<const uint32_t*>(welded.index.data()) + parts[size_t(i)].first_corner;
    for (const uint32_t count : parts[size_t(i)].corner_counts) {
      faces[size_t(i)].add_polygon(at, count);
      at += count;
    }
  });
  TriangleSoup soup = join_soup(source, std::move(welded.vertices), faces);
  if (!solids.empty()) soup.attributes = {groups_of_solids(source, std::move(solids), parts, faces)};
  return soup;
}

}  // namespace

TriangleSoup read_stl(const MeshSource& source) { return is_binary(source) ? read_binary(source) : read_text(source); }

void write_stl(OutputFile& file, const TriangleMesh& mesh, const Placement& placement, const MeshWriteOptions&) {
  if (mesh.triangles.size() > 0xffffffffu)
    throw Error(ErrorCode::unwritable_output, "write",
                "the mesh has " + std::to_string(mesh.triangles.size()) +
                    " triangles; an STL file holds at most 4294967295, write PLY");
  std::string header = "binary STL by isoshell";  // must not begin with "solid"
  if (const std::string note = offset_note(placement); !note.empty() && header.size() + 2 + note.size() <= 80)
    header += ", " + note;
  header.resize(80, ' ');
  for (int i = 0; i < 4; ++i) header += char(mesh.triangles.size() >> 8 * i & 0xff);
  file.write(header);
  write_rows(file, int64_t(mesh.triangles.size()), 50, [&](int64_t i, RowBuffer& out) {
    const auto& t = mesh.triangles[size_t(i)];
    WorldPoint corners[3];
    for (size_t c = 0; c < 3; ++c) corners[c] = placement.about_origin(mesh.vertices[t[c]]);
    for (const WorldPoint& p : {normal_of(corners[0], corners[1], corners[2]), corners[0], corners[1], corners[2]}) {
      out.put_binary(float(p.x));
      out.put_binary(float(p.y));
      out.put_binary(float(p.z));
    }
    out.put_binary(uint16_t(0));
  });
}

}  // namespace isoshell
