// What spreads along the edges of a mesh in rounds, against a search from the least value on.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>
#include <vector>

#include "features/mesh/vertex_graph.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/voxel_set.h"
#include "support/catch.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

/// Triangles between random points of a small grid: many ways are equally long, and some points are the same.
FineMesh random_mesh(uint64_t seed, uint32_t vertices, uint32_t triangles) {
  FineMesh mesh;
  for (uint32_t v = 0; v < vertices; ++v) {
    const uint64_t bits = random_bits(seed, v);
    mesh.position.push_back({double(bits & 7), double(bits >> 8 & 7), double(bits >> 16 & 7)});
  }
  for (uint32_t t = 0; t < triangles; ++t) {
    const uint64_t bits = random_bits(seed + 1, t);
    const uint32_t a = uint32_t(bits >> 40) % vertices, b = uint32_t(bits >> 20 & 0xfffff) % vertices,
                   c = uint32_t(bits & 0xfffff) % vertices;
    if (a != b && b != c && c != a) mesh.triangles.push_back({a, b, c});
  }
  return mesh;
}

/// Dijkstra's search with a queue.
template <class Value, class Step>
std::vector<Value> searched(const FineMesh& mesh, const std::vector<Value>& own, Step step) {
  using Offer = std::pair<Value, uint32_t>;
  std::vector<std::vector<uint32_t>> neighbours(own.size());
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) {
      neighbours[t[i]].push_back(t[(i + 1) % 3]);
      neighbours[t[i]].push_back(t[(i + 2) % 3]);
    }
  std::vector<Value> value = own;
  std::priority_queue<Offer, std::vector<Offer>, std::greater<Offer>> offers;
  for (uint32_t v = 0; v < own.size(); ++v) offers.push({own[v], v});
  while (!offers.empty()) {
    const auto [least, v] = offers.top();
    offers.pop();
    if (least != value[v]) continue;  // a smaller offer came first
    for (const uint32_t u : neighbours[v]) {
      const Value offered = step(least, std::sqrt(distance_sq(mesh.position[u], mesh.position[v])));
      if (!(offered < value[u])) continue;
      value[u] = offered;
      offers.push({offered, u});
    }
  }
  return value;
}

}  // namespace

TEST_CASE("vertex graph: lengths that grow along ways settle at what a search finds", "[curves][unit]") {
  for (const uint64_t seed : {1, 2, 3, 4, 5}) {
    const FineMesh mesh = random_mesh(seed, 2000, 1500);  // sparse: values travel far, and some parts lie apart
    std::vector<double> own;
    for (size_t v = 0; v < mesh.position.size(); ++v) {
      const uint64_t bits = random_bits(seed + 100, v);
      own.push_back(bits % 50 == 0 ? double(bits >> 32 & 3) : 40);
    }
    for (const double growth : {.25, 0., 20.}) {
      INFO("growth " << growth);
      const auto step = [&](double length, double way) { return length + growth * way; };
      const std::vector<double> expected = searched(mesh, own, step);
      CHECK(least_values(find_vertex_graph(mesh), own, step) == expected);
    }
  }
}

TEST_CASE("vertex graph: of sources that are equally near the smallest is found, and none beyond reach",
          "[curves][unit]") {
  using Nearest = std::pair<double, uint32_t>;  // distance, source
  for (const uint64_t seed : {6, 7, 8, 9, 10}) {
    const FineMesh mesh = random_mesh(seed, 2000, 4000);
    std::vector<Nearest> own(mesh.position.size(), Nearest{kFar, kNone});
    for (uint32_t v = 0; v < own.size(); ++v)
      if (random_bits(seed + 100, v) % 20 == 0) own[v] = {0, v};
    const auto step = [](const Nearest& from, double way) {
      return from.first + way <= 9 ? Nearest{from.first + way, from.second} : Nearest{kFar, kNone};
    };
    const std::vector<Nearest> found = least_values(find_vertex_graph(mesh), own, step);
    CHECK(found == searched(mesh, own, step));
    CHECK(std::find(found.begin(), found.end(), Nearest{kFar, kNone}) != found.end());
  }
}
