#include "io/mesh/precision.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <limits>

#include "geometry/world_vector.h"
#include "io/bytes/row_buffer.h"
#include "isoshell/io/mesh_file.h"

namespace isoshell {
namespace {

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

void round_as_in_ply(TriangleMesh& mesh) {
  if (needs_double(mesh)) return;
  for (WorldPoint& p : mesh.vertices) p = {double(float(p.x)), double(float(p.y)), double(float(p.z))};
}

}  // namespace isoshell
