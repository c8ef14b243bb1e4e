#include "features/weld_for_features.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <tuple>

#include "core/buckets.h"

namespace isoshell {
namespace {

/// A vertex of the soup; its position lies beside its number for the sort.
struct UsedVertex {
  WorldPoint at;
  uint32_t number;

  bool operator<(const UsedVertex& o) const {
    return std::tie(at.x, at.y, at.z, number) < std::tie(o.at.x, o.at.y, o.at.z, o.number);
  }
};

/// Those that triangles use, by position, then by number.
std::vector<UsedVertex> used_by_position(const TriangleSoup& soup) {
  std::vector<uint8_t> is_used(soup.vertices.size(), 0);
  for (const auto& t : soup.triangles)
    for (const uint32_t v : t) is_used[v] = 1;
  std::vector<UsedVertex> used;
  used.reserve(is_used.size());
  for (uint32_t v = 0; v < is_used.size(); ++v)
    if (is_used[v]) used.push_back({soup.vertices[v], v});
  tbb::parallel_sort(used.begin(), used.end());
  return used;
}

/// Per vertex of the soup its vertex in the mesh.
std::vector<uint32_t> weld_vertices(const TriangleSoup& soup, FeatureMesh& mesh) {
  std::vector<uint32_t> welded(soup.vertices.size(), 0);
  const std::vector<UsedVertex> used = used_by_position(soup);
  mesh.vertices.reserve(used.size());
  for (const auto& [p, v] : used) {
    const bool is_known = !mesh.vertices.empty() && mesh.vertices.back().x == p.x && mesh.vertices.back().y == p.y &&
                          mesh.vertices.back().z == p.z;
    if (!is_known) mesh.vertices.push_back({p.x + 0.0, p.y + 0.0, p.z + 0.0});  // -0 becomes 0
    welded[v] = uint32_t(mesh.vertices.size() - 1);
  }
  return welded;
}

/// A triangle among those of its smallest corner.
struct WeldedTriangle {
  std::array<uint32_t, 2> others;  ///< corners, the smaller first
  uint32_t source_face;
  bool is_turned;  ///< runs from the smallest corner to the larger one of the others

  bool operator<(const WeldedTriangle& o) const {
    return std::tie(others, source_face) < std::tie(o.others, o.source_face);
  }
  std::array<uint32_t, 3> corners(uint32_t smallest) const {
    return {smallest, others[is_turned ? 1 : 0], others[is_turned ? 0 : 1]};
  }
};
using WeldedTriangles = Buckets<WeldedTriangle>;

WeldedTriangles by_smallest_corner(const TriangleSoup& soup, const std::vector<uint32_t>& welded, size_t vertices) {
  return sort_into_buckets<WeldedTriangle>(int64_t(vertices), int64_t(soup.triangles.size()), [&](int64_t t, auto put) {
    const auto& corner = soup.triangles[size_t(t)];
    const uint32_t c[3] = {welded[corner[0]], welded[corner[1]], welded[corner[2]]};
    if (c[0] == c[1] || c[1] == c[2] || c[2] == c[0]) return;
    const size_t first = size_t(std::min_element(c, c + 3) - c);
    const uint32_t a = c[(first + 1) % 3], b = c[(first + 2) % 3];
    put(c[first], WeldedTriangle{{std::min(a, b), std::max(a, b)}, uint32_t(t), b < a});
  });
}

/// Calls visit(triangle) for the first one of the same corners, of those whose smallest corner a vertex is.
template <class Visit>
void for_each_first(const WeldedTriangles& all, int64_t vertex, Visit visit) {
  const View<const WeldedTriangle> in = all.in(vertex);
  for (int64_t i = 0; i < in.size; ++i)
    if (i == 0 || in[i].others != in[i - 1].others) visit(in[i]);
}

}  // namespace

FeatureMesh weld_for_features(const TriangleSoup& soup) {
  FeatureMesh mesh;
  const std::vector<uint32_t> welded = weld_vertices(soup, mesh);
  const WeldedTriangles all = by_smallest_corner(soup, welded, mesh.vertices.size());
  Buffer<int64_t> first(all.first.size());
  first[all.count()] = 0;
  for_each_index(int64_t(0), all.count(), [&](int64_t v) {
    int64_t count = 0;
    for_each_first(all, v, [&](const WeldedTriangle&) { ++count; });
    first[v] = count;
  });
  offsets_from_counts(first.view());
  mesh.triangles.resize(size_t(first[all.count()]));
  mesh.source_face.resize(mesh.triangles.size());
  for_each_index(int64_t(0), all.count(), [&](int64_t v) {
    auto at = size_t(first[v]);
    for_each_first(all, v, [&](const WeldedTriangle& t) {
      mesh.triangles[at] = t.corners(uint32_t(v));
      mesh.source_face[at++] = t.source_face;
    });
  });
  return mesh;
}

}  // namespace isoshell
