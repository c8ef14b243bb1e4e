// PLY, OBJ, STL and OFF out: rows are formatted in parallel, a batch of blocks at a time, and written in order.
#include "io/mesh/mesh_writers.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <limits>
#include <set>
#include <type_traits>
#include <vector>

#include "core/number_type.h"
#include "core/world_vector.h"
#include "io/mesh/ply_attributes.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr int64_t kRowsPerBlock = 1 << 14, kBlocksPerBatch = 64;

// Bytes of one block of rows; the largest row is known, so rows are appended without a check.
class RowBuffer {
 public:
  void reserve(int64_t bytes) {
    bytes_.resize(size_t(bytes));
    at_ = bytes_.data();
  }
  void put(char c) { *at_++ = c; }
  void put_number(double value) { at_ = std::to_chars(at_, bytes_.data() + bytes_.size(), value).ptr; }
  void put_number(float value) { at_ = std::to_chars(at_, bytes_.data() + bytes_.size(), value).ptr; }
  void put_number(uint32_t value) { at_ = std::to_chars(at_, bytes_.data() + bytes_.size(), value).ptr; }
  // Little-endian, on any machine.
  template <class T>
  void put_binary(T value) {
    using Small = std::conditional_t<sizeof(T) == 1, uint8_t, uint16_t>;
    using Bits = std::conditional_t<sizeof(T) == 8, uint64_t, std::conditional_t<sizeof(T) == 4, uint32_t, Small>>;
    Bits bits;
    std::memcpy(&bits, &value, sizeof value);
    for (size_t i = 0; i < sizeof(T); ++i) *at_++ = char(bits >> 8 * i & 0xff);
  }
  const char* data() const { return bytes_.data(); }
  int64_t size() const { return at_ - bytes_.data(); }

 private:
  std::vector<char> bytes_;
  char* at_ = nullptr;
};

// put(row, buffer) appends at most `largest_row` bytes.
template <class Put>
void write_rows(OutputFile& file, int64_t count, int64_t largest_row, Put put) {
  std::vector<RowBuffer> blocks(size_t(std::min(kBlocksPerBatch, (count + kRowsPerBlock - 1) / kRowsPerBlock)));
  for (int64_t base = 0; base < count; base += kBlocksPerBatch * kRowsPerBlock) {
    const int64_t here = std::min(kBlocksPerBatch, (count - base + kRowsPerBlock - 1) / kRowsPerBlock);
    tbb::parallel_for(int64_t(0), here, [&](int64_t b) {
      const int64_t first = base + b * kRowsPerBlock, last = std::min(count, first + kRowsPerBlock);
      blocks[size_t(b)].reserve((last - first) * largest_row);
      for (int64_t row = first; row < last; ++row) put(row, blocks[size_t(b)]);
    });
    for (int64_t b = 0; b < here; ++b) file.write(blocks[size_t(b)].data(), blocks[size_t(b)].size());
  }
}

constexpr int64_t kLongestDouble = 24, kLongestIndex = 10;

void put_text(RowBuffer& out, const WorldPoint& p) {
  out.put_number(p.x);
  out.put(' ');
  out.put_number(p.y);
  out.put(' ');
  out.put_number(p.z);
}

/// What a colour's values are divided by: they go from 0 to 1 in OBJ files.
double largest_of(NumberType type) {
  return with_type(type, [](auto number) {
    using T = decltype(number);
    return std::is_integral_v<T> ? double(std::numeric_limits<T>::max()) : 1.0;
  });
}

void put_text(RowBuffer& out, const std::array<uint32_t, 3>& t, uint32_t first_index) {
  for (int i = 0; i < 3; ++i) {
    out.put_number(t[size_t(i)] + first_index);
    out.put(i < 2 ? ' ' : '\n');
  }
}

void put_binary(RowBuffer& out, const VertexAttribute& a, int64_t vertex) {
  with_type(a.type, [&](auto number) {
    for (int32_t c = 0; c < a.components; ++c)
      out.put_binary(nearest_of<decltype(number)>(a.values[size_t(vertex * a.components + c)]));
  });
}

/// Lines of the header. Throws: usage for a name that a line before has.
std::string ply_properties(const TriangleMesh& mesh) {
  std::string lines = mesh.gap.empty() ? "" : "property uchar gap\n";
  std::set<std::string> names = {"x", "y", "z", "gap"};
  for (const VertexAttribute& a : mesh.attributes)
    for (const std::string& name : ply_names(a)) {
      if (!names.insert(name).second)
        throw Error(ErrorCode::usage, "write_mesh", "two properties of a vertex would have the name '" + name + "'");
      lines += std::string("property ") + name_of(a.type) + " " + name + "\n";
    }
  return lines;
}

template <class Real>
void write_ply_vertices(OutputFile& file, const TriangleMesh& mesh) {
  int64_t row_bytes = 3 * sizeof(Real) + 1;
  for (const VertexAttribute& a : mesh.attributes) row_bytes += a.components * size_of(a.type);
  write_rows(file, int64_t(mesh.vertices.size()), row_bytes, [&](int64_t i, RowBuffer& out) {
    const WorldPoint& p = mesh.vertices[size_t(i)];
    out.put_binary(Real(p.x));
    out.put_binary(Real(p.y));
    out.put_binary(Real(p.z));
    if (!mesh.gap.empty()) out.put(char(mesh.gap[size_t(i)]));
    for (const VertexAttribute& a : mesh.attributes) put_binary(out, a, i);
  });
}

// Unit normal; zero where the triangle has no area.
WorldPoint normal_of(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const WorldPoint n = doubled_area(a, b, c);
  const double size = length(n);
  if (!(size > 0) || !std::isfinite(size)) return {0, 0, 0};
  return {n.x / size, n.y / size, n.z / size};
}

template <class Value, class At>
Value extreme(int64_t count, Value start, At at, const Value& (*choose)(const Value&, const Value&)) {
  return tbb::parallel_reduce(
      tbb::blocked_range<int64_t>(0, count, kRowsPerBlock), start,
      [&](const tbb::blocked_range<int64_t>& r, Value best) {
        for (int64_t i = r.begin(); i < r.end(); ++i) best = choose(best, at(size_t(i)));
        return best;
      },
      [&](Value a, Value b) { return choose(a, b); });
}

}  // namespace

bool needs_double(const TriangleMesh& mesh) {
  const double infinity = std::numeric_limits<double>::infinity();
  const auto moved_sq = [&](size_t i) {
    const WorldPoint& p = mesh.vertices[i];
    return distance_sq({double(float(p.x)), double(float(p.y)), double(float(p.z))}, p);
  };
  const auto shortest_edge_sq = [&](size_t i) {
    const auto& t = mesh.triangles[i];
    const WorldPoint &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    return std::min({distance_sq(a, b), distance_sq(b, c), distance_sq(c, a)});
  };
  const double moved = extreme<double>(int64_t(mesh.vertices.size()), 0.0, moved_sq, std::max<double>);
  const double edge = extreme<double>(int64_t(mesh.triangles.size()), infinity, shortest_edge_sq, std::min<double>);
  return moved * 1e6 > edge;
}

void write_ply(OutputFile& file, const TriangleMesh& mesh) {
  const bool as_double = needs_double(mesh);
  const std::string type = as_double ? "double" : "float";
  file.write("ply\nformat binary_little_endian 1.0\nelement vertex " + std::to_string(mesh.vertices.size()) +
             "\nproperty " + type + " x\nproperty " + type + " y\nproperty " + type + " z\n" + ply_properties(mesh) +
             "element face " + std::to_string(mesh.triangles.size()) +
             "\nproperty list uchar uint vertex_indices\nend_header\n");
  if (as_double)
    write_ply_vertices<double>(file, mesh);
  else
    write_ply_vertices<float>(file, mesh);
  write_rows(file, int64_t(mesh.triangles.size()), 13, [&](int64_t i, RowBuffer& out) {
    out.put(char(3));
    for (const uint32_t corner : mesh.triangles[size_t(i)]) out.put_binary(corner);
  });
}

void write_obj(OutputFile& file, const TriangleMesh& mesh) {
  const VertexAttribute* color = nullptr;
  for (const VertexAttribute& a : mesh.attributes)
    if (a.name == kColorName && a.components >= 3) color = &a;
  const double largest = color ? largest_of(color->type) : 1;
  write_rows(file, int64_t(mesh.vertices.size()), 3 + 6 * (kLongestDouble + 1), [&](int64_t i, RowBuffer& out) {
    out.put('v');
    out.put(' ');
    put_text(out, mesh.vertices[size_t(i)]);
    for (size_t c = 0; color && c < 3; ++c) {
      out.put(' ');
      out.put_number(float(color->values[size_t(i * color->components) + c] / largest));
    }
    out.put('\n');
  });
  write_rows(file, int64_t(mesh.triangles.size()), 2 + 3 * (kLongestIndex + 1), [&](int64_t i, RowBuffer& out) {
    out.put('f');
    out.put(' ');
    put_text(out, mesh.triangles[size_t(i)], 1);
  });
}

void write_off(OutputFile& file, const TriangleMesh& mesh) {
  file.write("OFF\n" + std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n");
  write_rows(file, int64_t(mesh.vertices.size()), 3 * (kLongestDouble + 1), [&](int64_t i, RowBuffer& out) {
    put_text(out, mesh.vertices[size_t(i)]);
    out.put('\n');
  });
  write_rows(file, int64_t(mesh.triangles.size()), 2 + 3 * (kLongestIndex + 1), [&](int64_t i, RowBuffer& out) {
    out.put('3');
    out.put(' ');
    put_text(out, mesh.triangles[size_t(i)], 0);
  });
}

void write_stl(OutputFile& file, const TriangleMesh& mesh) {
  if (mesh.triangles.size() > 0xffffffffu)
    throw Error(ErrorCode::unwritable_output, "write",
                "the mesh has " + std::to_string(mesh.triangles.size()) +
                    " triangles; an STL file holds at most 4294967295, write PLY");
  std::string header = "binary STL by isoshell";  // must not begin with "solid"
  header.resize(80, ' ');
  for (int i = 0; i < 4; ++i) header += char(mesh.triangles.size() >> 8 * i & 0xff);
  file.write(header);
  write_rows(file, int64_t(mesh.triangles.size()), 50, [&](int64_t i, RowBuffer& out) {
    const auto& t = mesh.triangles[size_t(i)];
    const WorldPoint corners[] = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    for (const WorldPoint& p : {normal_of(corners[0], corners[1], corners[2]), corners[0], corners[1], corners[2]}) {
      out.put_binary(float(p.x));
      out.put_binary(float(p.y));
      out.put_binary(float(p.z));
    }
    out.put_binary(uint16_t(0));
  });
}

}  // namespace isoshell
