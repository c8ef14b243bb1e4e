// STL and OFF out, and what decides how precise PLY is.
#include "io/mesh/mesh_writers.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/world_vector.h"
#include "io/bytes/row_buffer.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

void put_text(RowBuffer& out, const std::array<uint32_t, 3>& t) {
  for (int i = 0; i < 3; ++i) {
    out.put_number(t[size_t(i)]);
    out.put(i < 2 ? ' ' : '\n');
  }
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

void write_off(OutputFile& file, const TriangleMesh& mesh) {
  file.write("OFF\n" + std::to_string(mesh.vertices.size()) + " " + std::to_string(mesh.triangles.size()) + " 0\n");
  write_rows(file, int64_t(mesh.vertices.size()), 3 * (kLongestDouble + 1), [&](int64_t i, RowBuffer& out) {
    put_text(out, mesh.vertices[size_t(i)]);
    out.put('\n');
  });
  write_rows(file, int64_t(mesh.triangles.size()), 2 + 3 * (kLongestIndex + 1), [&](int64_t i, RowBuffer& out) {
    out.put('3');
    out.put(' ');
    put_text(out, mesh.triangles[size_t(i)]);
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

void round_as_in_ply(TriangleMesh& mesh) {
  if (needs_double(mesh)) return;
  for (WorldPoint& p : mesh.vertices) p = {double(float(p.x)), double(float(p.y)), double(float(p.z))};
}

}  // namespace isoshell
