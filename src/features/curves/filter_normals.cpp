// filter_normals (see face_normals.h), in lanes of triangles.
#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <utility>

#include "core/parallel_ranges.h"
#include "core/vector_versions.h"
#include "features/curves/face_normals.h"

namespace isoshell {
namespace {

constexpr int kRounds = 20;
constexpr double kStill = 1e-6;        // squared difference of normals that ends the rounds
constexpr double kMostApartSq = .468;  // of normals of one smooth surface: 40 degrees
constexpr int kLanes = 8;

/// Where a triangle is, and how large.
struct Place {
  WorldPoint centre;
  double area;
};

/// Triangles side by side: what they and their neighbours weigh but for their normals. 0 where there is none.
struct Links {
  double own_weight[kLanes];
  double weight[3][kLanes];
  uint32_t face[3][kLanes];
};

Buffer<Place> places_of(const FeatureMesh& mesh) {
  Buffer<Place> places(int64_t(mesh.triangles.size()));
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    const auto& corner = mesh.triangles[t];
    const WorldPoint &a = mesh.vertices[corner[0]], &b = mesh.vertices[corner[1]], &c = mesh.vertices[corner[2]];
    places[int64_t(t)] = {1. / 3 * (a + b + c), triangle_area(a, b, c)};
  });
  return places;
}

/// Weights are areas, less with the distance of the triangles' centres.
Buffer<Links> link_triangles(const FeatureMesh& mesh, const MeshEdges& edges, double reach_world) {
  const Buffer<Place> places = places_of(mesh);
  Buffer<Links> links((places.size() + kLanes - 1) / kLanes);
  const auto link = [&](uint32_t t, Links& made, size_t lane) {
    const Place& own = places[t];
    made.own_weight[lane] = own.area;
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t e = edges.of_triangle[t][i];
      if (!edges.is_inner(e)) continue;
      const uint32_t face = edges.across(e, t);
      const double near = 1 / (1 + distance_sq(own.centre, places[face].centre) / (reach_world * reach_world));
      made.face[i][lane] = face;
      made.weight[i][lane] = places[face].area * near * near;
    }
  };
  for_each_index(int64_t(0), links.size(), [&](int64_t g) {
    links[g] = {};
    const int64_t first = g * kLanes, count = std::min<int64_t>(kLanes, places.size() - first);
    for (int64_t i = 0; i < count; ++i) link(uint32_t(first + i), links[g], size_t(i));
  });
  return links;
}

struct NormalLanes {
  double x[kLanes], y[kLanes], z[kLanes];

  WorldPoint at(int lane) const { return {x[lane], y[lane], z[lane]}; }
  void set(int lane, const WorldPoint& n) {
    x[lane] = n.x;
    y[lane] = n.y;
    z[lane] = n.z;
  }
};

/// One round for the triangles of `links` from `begin` to `end`. Result: the largest square of a normal's move.
/// Branches are choices between two values, so that loops over lanes become vectors.
ISOSHELL_VECTOR_VERSIONS double filter_lanes(View<const Links> links, int64_t begin, int64_t end,
                                             const WorldPoint* normals, WorldPoint* next) {
  double most[kLanes] = {};
  for (int64_t g = begin; g < end; ++g) {
    const Links& link = links[g];
    NormalLanes own, other[3], filtered;
    for (int i = 0; i < kLanes; ++i) own.set(i, normals[g * kLanes + i]);
    for (int k = 0; k < 3; ++k)
      for (int i = 0; i < kLanes; ++i) other[k].set(i, normals[link.face[k][i]]);
    for (int i = 0; i < kLanes; ++i) {
      const WorldPoint was = own.at(i);
      WorldPoint sum = link.own_weight[i] * was;
      for (int k = 0; k < 3; ++k) {
        const WorldPoint n = other[k].at(i);
        const double alike = 1 - (1 / kMostApartSq) * distance_sq(was, n);
        const WorldPoint more = sum + (link.weight[k][i] * alike * alike) * n;
        sum = {alike > 0 ? more.x : sum.x, alike > 0 ? more.y : sum.y, alike > 0 ? more.z : sum.z};
      }
      const double size = length(sum);
      const WorldPoint unit = (1 / size) * sum;
      const WorldPoint now = {size > 0 ? unit.x : was.x, size > 0 ? unit.y : was.y, size > 0 ? unit.z : was.z};
      const double moved = distance_sq(now, was);
      most[i] = most[i] < moved ? moved : most[i];
      filtered.set(i, now);
    }
    for (int i = 0; i < kLanes; ++i) next[g * kLanes + i] = filtered.at(i);
  }
  return *std::max_element(most, most + kLanes);
}

}  // namespace

Buffer<WorldPoint> filter_normals(const FeatureMesh& mesh, const MeshEdges& edges, View<const WorldPoint> normals,
                                  double reach_world) {
  const Buffer<Links> links = link_triangles(mesh, edges, reach_world);
  Buffer<WorldPoint> now(links.size() * kLanes), next(now.size());
  for_each_index(int64_t(0), now.size(), [&](int64_t t) {
    now[t] = t < normals.size ? normals[t] : WorldPoint{0, 0, 0};
  });
  using Range = tbb::blocked_range<int64_t>;
  tbb::affinity_partitioner same_threads;  // a round finds in a core's cache what that core wrote in the one before
  for (int round = 0; round < kRounds; ++round) {
    const double moved = tbb::parallel_reduce(
        Range(0, links.size(), 512 / kLanes), 0.,
        [&](const Range& r, double most) {
          return std::max(most, filter_lanes(links.view(), r.begin(), r.end(), now.data(), next.data()));
        },
        [](double a, double b) { return std::max(a, b); }, same_threads);
    std::swap(now, next);
    if (moved < kStill) break;
  }
  return now;
}

}  // namespace isoshell
