// Measures of borders, intersections of triangles on the lattice, and fans that touch, on meshes that can be counted.
#include <cmath>

#include "features/mesh/curve_paths.h"
#include "features/mesh/separate_fans.h"
#include "features/mesh/weld_for_features.h"
#include "isoshell/borders.h"
#include "measure/crossings.h"
#include "support/catch.h"
#include "support/soup_sheet.h"
#include "voxel/intersect.h"

using namespace isoshell;

namespace {

/// A unit square of two triangles at a corner.
void add_square(TriangleMesh& mesh, WorldPoint at) {
  const auto first = uint32_t(mesh.vertices.size());
  for (const auto& [x, y] : {std::pair(0, 0), {1, 0}, {1, 1}, {0, 1}})
    mesh.vertices.push_back({at.x + x, at.y + y, at.z});
  mesh.triangles.push_back({first, first + 1, first + 2});
  mesh.triangles.push_back({first, first + 2, first + 3});
}

}  // namespace

TEST_CASE("border measures: loops, lengths and distances both ways", "[borders]") {
  Context context;
  TriangleMesh mesh, reference;
  add_square(mesh, {0, 0, 0.25});
  add_square(reference, {0, 0, 0});
  add_square(reference, {5, 0, 0});
  const BorderMeasures found = measure_borders(mesh, reference, context);
  CHECK(found.loops == 1);
  CHECK(found.length_world == 4);
  CHECK(found.reference_loops == 2);
  CHECK(found.reference_length_world == 8);
  CHECK(found.to_reference_max == 0.25);
  CHECK(found.from_reference_max > 5);
}

TEST_CASE("border measures: loops that touch in a vertex are as many as the fans around it", "[borders]") {
  Context context;
  TriangleMesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  CHECK(measure_borders(mesh, mesh, context).loops == 2);
  mesh.triangles.push_back({0, 2, 3});
  CHECK(measure_borders(mesh, mesh, context).loops == 1);
}

TEST_CASE("border measures: a closed mesh has none", "[borders]") {
  Context context;
  TriangleMesh closed, square;
  closed.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  closed.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  add_square(square, {0, 0, 0});
  const BorderMeasures found = measure_borders(closed, square, context);
  CHECK(found.loops == 0);
  CHECK(found.length_world == 0);
  CHECK(found.to_reference_max == 0);
}

TEST_CASE("crossings: triangles that meet outside of shared corners, and where", "[borders]") {
  Context context;
  const Buffer<PointQ8> points = to_buffer(std::vector<PointQ8>{{0, 0, 0},
                                                                {1000, 0, 0},
                                                                {0, 1000, 0},
                                                                {1000, 1000, 0},  // neighbour of the first
                                                                {100, 100, -50},
                                                                {200, 100, -50},
                                                                {150, 150, 50},  // through the first
                                                                {5000, 0, 0},
                                                                {5100, 0, 0},
                                                                {5000, 100, 0}});
  const Buffer<TriangleIndices> triangles =
      to_buffer(std::vector<TriangleIndices>{{0, 1, 2}, {1, 3, 2}, {4, 5, 6}, {7, 8, 9}});
  const auto found = find_crossings(points.view(), triangles.view(), context);
  REQUIRE(found.size() == 1);
  CHECK(found[0].min.x == 100);
  CHECK(found[0].max.x == 200);
  CHECK(which_apart(found, found, 0).size() == size_t(0));
  const std::vector<BoxQ8> elsewhere = {{{300, 100, 0}, {400, 200, 0}}};
  CHECK(which_apart(found, elsewhere, 99).size() == size_t(1));
  CHECK(which_apart(found, elsewhere, 100).size() == size_t(0));
  CHECK(which_apart(found, {}, 1000).size() == size_t(1));
}

TEST_CASE("crossings: those of any triangles are those that each pair of them shows", "[borders]") {
  Context context;
  std::vector<PointQ8> points;
  std::vector<TriangleIndices> triangles;
  uint32_t state = 1;
  const auto random = [&](uint32_t below) {
    return int32_t((state = state * 1664525u + 1013904223u) >> 8) % int32_t(below);
  };
  const auto add = [&](int32_t range, int32_t size, int32_t height) {
    const PointQ8 at{random(uint32_t(range)), random(uint32_t(range)), random(uint32_t(height))};
    for (uint32_t i = 0; i < 3; ++i)
      points.push_back({at.x + random(uint32_t(size)), at.y + random(uint32_t(size)), at.z + random(uint32_t(size))});
    const auto n = uint32_t(points.size());
    triangles.push_back({n - 3, n - 2, n - 1});
  };
  for (int i = 0; i < 300; ++i) add(4000, 900, 4000);  // anywhere
  for (int i = 0; i < 300; ++i) add(4000, 600, 1);     // near a plane
  for (int i = 0; i < 300; ++i) add(40, 20, 40);       // small ones in a corner
  for (int i = 0; i < 5; ++i) add(10, 4000, 10);       // large ones
  triangles.push_back(triangles.back());               // the same corners: no crossing
  const auto corners = [&](size_t t) {
    const TriangleIndices& i = triangles[t];
    return CornersOfTriangle{{i.a, i.b, i.c}, {points[i.a], points[i.b], points[i.c]}};
  };
  std::vector<std::array<uint32_t, 2>> expected;
  for (uint32_t t = 0; t < triangles.size(); ++t)
    for (uint32_t u = t + 1; u < triangles.size(); ++u)
      if (triangles_intersect(corners(t), corners(u))) expected.push_back({t, u});
  REQUIRE(expected.size() > 500);
  const std::atomic<bool> stop{false};
  const auto position = to_buffer(points);
  const auto list = to_buffer(triangles);
  CHECK(crossing_pairs(position.view(), list.view(), {}, stop) == expected);
  const auto boxes = find_crossings(position.view(), list.view(), context);
  const std::vector<BoxQ8> some(boxes.begin(), boxes.begin() + 20);
  const auto are_apart = [](const BoxQ8& a, const BoxQ8& b) {
    const auto gap = [](int32_t lo, int32_t hi) { return lo - hi > 100; };
    return gap(a.min.x, b.max.x) || gap(b.min.x, a.max.x) || gap(a.min.y, b.max.y) || gap(b.min.y, a.max.y) ||
           gap(a.min.z, b.max.z) || gap(b.min.z, a.max.z);
  };
  const auto apart = std::count_if(boxes.begin(), boxes.end(), [&](const BoxQ8& b) {
    return std::all_of(some.begin(), some.end(), [&](const BoxQ8& o) { return are_apart(b, o); });
  });
  CHECK(apart > 0);
  CHECK(which_apart(boxes, some, 100).size() == size_t(apart));
}

TEST_CASE("fans: squares that touch in a corner get one each, and a place more is counted", "[borders]") {
  TriangleMesh both;
  add_square(both, {0, 0, 0});
  add_square(both, {1, 1, 0});
  TriangleSoup soup;
  soup.vertices = both.vertices;
  soup.triangles = both.triangles;
  const FeatureMesh mesh = weld_for_features(soup);
  REQUIRE(mesh.vertices.size() == 7);
  std::vector<WorldPoint> position = mesh.vertices;
  MeshTriangles triangles = mesh.triangles;
  const std::vector<uint32_t> separated = separate_fans(position, triangles);
  REQUIRE(separated.size() == 1);
  CHECK(position.size() == 8);
  CHECK(position.back().x == 1);
  CHECK(position.back().y == 1);
  CurveNetwork network;
  network.curves.push_back({CurveKind::border, false, {}});
  for (const auto& t : mesh.triangles)  // every edge of the first triangle of each square
    for (size_t i = 0; i < 3; ++i) network.curves.push_back({CurveKind::border, false, {t[i], t[(i + 1) % 3]}});
  network.curves.erase(network.curves.begin());
  CHECK(count_separated_places(mesh, network, triangles) == 1);
  CHECK(count_separated_places(mesh, {}, triangles) == 0);
  CHECK(separate_fans(position, triangles).empty());
}

TEST_CASE("jagged paths: borders that turn to and fro are, circles, straight ones and creases are not", "[borders]") {
  std::vector<WorldPoint> position;
  std::vector<CurvePath> paths;
  const auto add = [&](CurveKind kind, bool is_loop, double depth) {
    CurvePath path;
    path.kind = kind;
    path.is_loop = is_loop;
    for (uint32_t i = 0; i < 100; ++i) {
      const double out = i % 2 == 0 ? depth : 0, r = 1000 + out, turn = 6.283185307179586 * i / 100;
      path.vertex.push_back(uint32_t(position.size()));
      position.push_back(is_loop ? WorldPoint{r * std::cos(turn), r * std::sin(turn), 0} : WorldPoint{60. * i, out, 0});
    }
    measure_path(position, path);
    paths.push_back(path);
  };
  add(CurveKind::border, true, 0);
  add(CurveKind::border, false, 0);
  add(CurveKind::border, true, 40);
  add(CurveKind::border, false, 40);
  add(CurveKind::crease, true, 40);
  find_jagged_paths(position, 100, paths);
  const std::vector<bool> expected = {false, false, true, true, false};
  for (size_t p = 0; p < paths.size(); ++p) CHECK(paths[p].is_jagged == expected[p]);
}
