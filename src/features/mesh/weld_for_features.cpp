#include "features/mesh/weld_for_features.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>

#include "core/buckets.h"
#include "geometry/triangle_list.h"
#include "geometry/weld.h"
#include "geometry/world_vector.h"
#include "isoshell/distance.h"

namespace isoshell {
namespace {

constexpr double kThinSteps = 8;  ///< of the lattice: as high as what remove_slivers takes for thin there

WorldPoint without_negative_zero(const WorldPoint& p) { return {p.x + 0.0, p.y + 0.0, p.z + 0.0}; }

/// A point of a lattice, as a number to sort by.
struct NumberedPoint {
  uint64_t x_y;
  uint32_t z, number;

  bool operator<(const NumberedPoint& o) const { return x_y != o.x_y ? x_y < o.x_y : z < o.z; }
};

bool are_all_used(const LatticeSurface& surface) {
  std::vector<uint8_t> is_used(size_t(surface.points.size()), 0);
  const auto use = [&](uint32_t v) { __atomic_store_n(&is_used[v], uint8_t(1), __ATOMIC_RELAXED); };
  for_each_index(int64_t(0), surface.triangles.size(), [&](int64_t t) {
    const auto& [a, b, c] = surface.triangles[t];
    use(a), use(b), use(c);
  });
  return std::find(is_used.begin(), is_used.end(), 0) == is_used.end();
}

/// Points of a lattice are in the order of their positions in the world. None where some are not used, and where the
/// lattice is so fine and so far from the origin that rounding makes neighbours one.
std::optional<WeldedVertices> vertices_of(const LatticeSurface& surface) {
  if (!are_all_used(surface)) return {};
  const size_t count = size_t(surface.points.size());
  Buffer<NumberedPoint> points(surface.points.size());
  for_each_index(uint32_t(0), uint32_t(count), [&](uint32_t v) {
    const PointQ8& q = surface.points[v];
    points[v] = {uint64_t(uint32_t(q.x)) << 32 | uint32_t(q.y), uint32_t(q.z), v};
  });
  tbb::parallel_sort(points.begin(), points.end());
  WeldedVertices welded{std::vector<WorldPoint>(count), std::vector<uint32_t>(count)};
  for_each_index(uint32_t(0), uint32_t(count), [&](uint32_t i) {
    const uint32_t v = points[i].number;
    welded.position[i] = without_negative_zero(surface.frame.to_world(surface.points[v]));
    welded.place[v] = i;
  });
  for (size_t i = 1; i < count; ++i)
    if (!is_before(welded.position[i - 1], welded.position[i])) return {};
  return welded;
}

std::array<uint32_t, 3> corners_of(const std::array<uint32_t, 3>& t) { return t; }
std::array<uint32_t, 3> corners_of(const TriangleIndices& t) { return {t.a, t.b, t.c}; }

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

template <class Triangle>
WeldedTriangles by_smallest_corner(View<const Triangle> triangles, const WeldedVertices& welded) {
  const auto vertices = int64_t(welded.position.size());
  return sort_into_buckets<WeldedTriangle>(vertices, triangles.size, [&](int64_t t, auto put) {
    const std::array<uint32_t, 3> corner = corners_of(triangles[t]);
    const std::array<uint32_t, 3> c = {welded.place[corner[0]], welded.place[corner[1]], welded.place[corner[2]]};
    if (repeats_corner(c)) return;
    const size_t first = size_t(std::min_element(c.begin(), c.end()) - c.begin());
    const uint32_t a = c[(first + 1) % 3], b = c[(first + 2) % 3];
    put(c[first], WeldedTriangle{{std::min(a, b), std::max(a, b)}, uint32_t(t), b < a});
  });
}

/// Calls visit(triangle) for the first one of the same corners, of those whose smallest corner a vertex is; for none
/// where as many face one way as the other, and they are less high: what was between them has no inside any more.
template <class Visit>
void for_each_first(const WeldedTriangles& all, int64_t vertex, const std::vector<WorldPoint>& position,
                    double least_height_world, Visit visit) {
  const View<const WeldedTriangle> in = all.in(vertex);
  for (int64_t first = 0, end = 0; first < in.size; first = end) {
    int64_t turned = 0;
    for (end = first; end < in.size && in[end].others == in[first].others; ++end) turned += in[end].is_turned ? 1 : -1;
    const auto [a, b] = in[first].others;
    if (turned != 0 || triangle_height(position[size_t(vertex)], position[a], position[b]) >= least_height_world)
      visit(in[first]);
  }
}

void drop_unused_vertices(FeatureMesh& mesh) {
  std::vector<uint8_t> is_used(mesh.vertices.size(), 0);
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    for (const uint32_t v : mesh.triangles[t]) __atomic_store_n(&is_used[v], uint8_t(1), __ATOMIC_RELAXED);
  });
  if (std::find(is_used.begin(), is_used.end(), 0) == is_used.end()) return;
  std::vector<uint32_t> number(mesh.vertices.size());
  uint32_t count = 0;
  for (size_t v = 0; v < number.size(); ++v) {
    number[v] = count;
    if (is_used[v]) mesh.vertices[count++] = mesh.vertices[v];
  }
  mesh.vertices.resize(count);
  for (auto& t : mesh.triangles)
    for (uint32_t& v : t) v = number[v];
}

template <class Triangle>
FeatureMesh weld_triangles(View<const Triangle> triangles, WeldedVertices welded, double least_height_world) {
  const WeldedTriangles all = by_smallest_corner(triangles, welded);
  FeatureMesh mesh;
  mesh.vertices = std::move(welded.position);
  Buffer<int64_t> first(all.first.size());
  first[all.count()] = 0;
  for_each_index(int64_t(0), all.count(), [&](int64_t v) {
    int64_t count = 0;
    for_each_first(all, v, mesh.vertices, least_height_world, [&](const WeldedTriangle&) { ++count; });
    first[v] = count;
  });
  offsets_from_counts(first.view());
  mesh.triangles.resize(size_t(first[all.count()]));
  mesh.source_face.resize(mesh.triangles.size());
  for_each_index(int64_t(0), all.count(), [&](int64_t v) {
    auto at = size_t(first[v]);
    for_each_first(all, v, mesh.vertices, least_height_world, [&](const WeldedTriangle& t) {
      mesh.triangles[at] = t.corners(uint32_t(v));
      mesh.source_face[at++] = t.source_face;
    });
  });
  drop_unused_vertices(mesh);
  return mesh;
}

FeatureMesh weld_soup(const TriangleSoup& soup, double least_height_world) {
  const View<const std::array<uint32_t, 3>> triangles{soup.triangles.data(), int64_t(soup.triangles.size())};
  WeldedVertices vertices = weld_vertices(soup.vertices, soup.triangles);
  for (WorldPoint& p : vertices.position) p = without_negative_zero(p);
  return weld_triangles(triangles, std::move(vertices), least_height_world);
}

}  // namespace

FeatureMesh weld_for_features(const TriangleSoup& soup) { return weld_soup(soup, 0); }

FeatureMesh weld_for_features(const LatticeSurface& surface) {
  const double least_height_world = kThinSteps * surface.frame.voxel_size / kOneVoxelQ8;
  if (std::optional<WeldedVertices> vertices = vertices_of(surface))
    return weld_triangles(surface.triangles.view(), std::move(*vertices), least_height_world);
  TriangleMesh mesh = to_world(surface);
  TriangleSoup soup;
  soup.vertices = std::move(mesh.vertices);
  soup.triangles = std::move(mesh.triangles);
  return weld_soup(soup, least_height_world);
}

}  // namespace isoshell
