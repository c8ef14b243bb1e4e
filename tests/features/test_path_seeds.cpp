// Where seeds of curves are placed beside one another.
#include <algorithm>
#include <cmath>

#include "features/seeds/carried_positions.h"
#include "features/seeds/facing_curves.h"
#include "features/seeds/path_seeds.h"
#include "support/catch.h"

using namespace isoshell;

namespace {

constexpr double kEdge = 1000;

/// A flat strip in squares of a quarter of the edge length, with a path along either side.
FineMesh strip(uint32_t squares_long, uint32_t squares_wide) {
  constexpr double kStep = kEdge / 4;
  FineMesh mesh;
  const auto number = [&](uint32_t i, uint32_t j) { return i * (squares_wide + 1) + j; };
  for (uint32_t i = 0; i <= squares_long; ++i)
    for (uint32_t j = 0; j <= squares_wide; ++j) mesh.position.push_back({kStep * i, kStep * j, 0});
  for (uint32_t i = 0; i < squares_long; ++i)
    for (uint32_t j = 0; j < squares_wide; ++j) {
      mesh.triangles.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      mesh.triangles.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  mesh.edge_length.assign(mesh.position.size(), kEdge);
  for (const uint32_t j : {0u, squares_wide}) {
    CurvePath path;
    path.curve = j > 0;
    for (uint32_t i = 0; i <= squares_long; ++i) path.vertex.push_back(number(i, j));
    measure_path(mesh.position, path);
    mesh.paths.push_back(std::move(path));
  }
  return mesh;
}

std::vector<double> placed(const CurvePath& path) {
  std::vector<double> at;
  for (const PathPoint& seed : path.seeds) at.push_back((double(seed.edge) + seed.part) * kEdge / 4);
  return at;
}

double distance_to_nearest(const std::vector<double>& seeds, double at) {
  double nearest = 1e9;
  for (const double s : seeds) nearest = std::min(nearest, std::abs(s - at));
  return nearest;
}

FineMesh with_seeds(FineMesh mesh, const std::vector<WorldPoint>& before = {}) {
  const VertexGraph graph = find_vertex_graph(mesh);
  place_path_seeds(mesh, find_facing_vertices(mesh, graph, kEdge), before);
  return mesh;
}

}  // namespace

TEST_CASE("path seeds: across a strip as wide as edges are long, seeds are between those of the other side",
          "[curves][unit]") {
  const FineMesh mesh = with_seeds(strip(60, 4));
  const std::vector<double> one = placed(mesh.paths[0]), other = placed(mesh.paths[1]);
  for (const double at : one) {
    if (at < 2 * kEdge || at > 13 * kEdge) continue;  // both sides begin and end at right angles
    INFO("at " << at);
    CHECK(distance_to_nearest(other, at) > 0.3 * kEdge);
  }
  for (const auto& seeds : {one, other})
    for (size_t i = 0; i + 1 < seeds.size(); ++i) {
      CHECK(seeds[i + 1] - seeds[i] > 0.5 * kEdge);
      CHECK(seeds[i + 1] - seeds[i] < 1.4 * kEdge);
    }
}

TEST_CASE("path seeds: across three edge lengths, seeds stand one edge length apart on either side", "[curves][unit]") {
  const FineMesh mesh = with_seeds(strip(60, 12));
  for (const CurvePath& path : mesh.paths) {
    const std::vector<double> seeds = placed(path);
    REQUIRE(seeds.size() == 16);
    for (size_t i = 0; i < seeds.size(); ++i) CHECK(std::abs(seeds[i] - kEdge * double(i)) < 1);
  }
}

TEST_CASE("facing curves: the sides of a strip face each other, and the halves of one side do not", "[curves][unit]") {
  const FineMesh mesh = strip(40, 3);
  const VertexGraph graph = find_vertex_graph(mesh);
  const std::vector<FacingVertices> facing = find_facing_vertices(mesh, graph, kEdge);
  REQUIRE(!facing.empty());
  for (const FacingVertices& f : facing) {
    const bool first_on_one = f.on_path[0] % 4 == 0, second_on_one = f.on_path[1] % 4 == 0;
    CHECK(first_on_one != second_on_one);
    CHECK(std::abs(f.gap - 0.75 * kEdge) < 1);
  }
}

TEST_CASE("path seeds: those of the frame before stay where they are, as far as edges have a good length",
          "[curves][unit]") {
  std::vector<WorldPoint> before;
  for (int i = 1; i < 15; ++i) before.push_back({(i + 0.3 * std::sin(double(i))) * kEdge, 0, 0});
  before.push_back({4.2 * kEdge, 0.09 * kEdge, 0});  // too near to others to stay beside them
  before.push_back({8.5 * kEdge, 0.11 * kEdge, 0});  // not on the path
  const std::vector<double> seeds = placed(with_seeds(strip(60, 12), before).paths[0]);
  REQUIRE(seeds.size() == 16);
  for (size_t i = 1; i < 15; ++i) CHECK(std::abs(seeds[i] - before[i - 1].x) < 0.03 * kEdge);  // or at a vertex there
}

TEST_CASE("carried places: a point lies on the nearest path, if any is near", "[curves][unit]") {
  const FineMesh mesh = strip(60, 4);
  const std::vector<PositionOnPath> places = positions_on_paths(
      mesh,
      {{1.3 * kEdge, 0.05 * kEdge, 0}, {2 * kEdge, 0.95 * kEdge, 0}, {2 * kEdge, kEdge / 2, 0}, {15 * kEdge, 0, 0}});
  CHECK(places[0].path == 0);
  CHECK(places[0].at.edge == 5);
  CHECK(places[0].at.part == Approx(0.2));
  CHECK(places[1].path == 1);
  CHECK(places[2].path == PositionOnPath::kNoPath);
  CHECK(places[3].at.edge == mesh.paths[0].edge_count());
}
