// Borders, creases and corners of shapes whose curves are known.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <vector>

#include "features/curves/find_curves.h"
#include "features/known_curves.h"
#include "features/mesh/weld_for_features.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/shapes.h"

using namespace isoshell;
using namespace isoshell::known_curves;

namespace {

/// The curves as positions.
std::vector<std::vector<std::array<double, 3>>> places_of(const FeatureMesh& mesh, const CurveNetwork& network) {
  std::vector<std::vector<std::array<double, 3>>> places;
  for (const FeatureCurve& c : network.curves) {
    places.push_back({});
    for (const uint32_t v : c.vertex)
      places.back().push_back({mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z});
  }
  return places;
}

}  // namespace

TEST_CASE("weld: equal positions are one vertex, and degenerate and repeated triangles are dropped", "[curves][unit]") {
  TriangleSoup soup;
  soup.vertices = {{1, 0, 0}, {0, 1, 0}, {-0.0, 0, 0}, {0, 0, -0.0}, {1, 0, 0}, {NAN, 0, 0}};
  soup.triangles = {{2, 3, 0}, {2, 0, 1}, {1, 3, 4}, {0, 3, 1}};
  const FeatureMesh mesh = weld_for_features(soup);
  REQUIRE(mesh.vertices.size() == 3);
  CHECK(mesh.vertices[0].x == 0);
  CHECK_FALSE(std::signbit(mesh.vertices[0].x));
  CHECK(mesh.triangles == std::vector<std::array<uint32_t, 3>>{{0, 2, 1}});
  CHECK(mesh.source_face == std::vector<uint32_t>{1});
}

TEST_CASE("curves: a cube has twelve creases and eight corners, however it is turned and subdivided",
          "[curves][unit]") {
  for (const int n : {1, 2, 7, 20})
    for (const double h : {.05, .2, .4}) {
      INFO(n << " squares, edge length " << h);
      CHECK(counts_of(cube(n), h) == only_creases(12, 0, 8));
      CHECK(counts_of(turned(cube(n)), h) == only_creases(12, 0, 8));
    }
}

TEST_CASE("curves: a shaken cube has the curves of a cube", "[curves][unit]") {
  for (const int n : {10, 25})
    for (const double edges : {1., 2., 4.}) {
      INFO(n << " squares, " << edges << " of their edges long");
      CHECK(counts_of(shaken(cube(n), .05 / n), edges / n) == only_creases(12, 0, 8));
    }
}

TEST_CASE("curves: an L has eighteen creases and twelve corners", "[curves][unit]") {
  for (const int n : {1, 5})
    CHECK(counts_of(cells({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, n), .2) == only_creases(18, 0, 12));
}

TEST_CASE("curves: a plate with a square hole has the creases of two boxes", "[curves][unit]") {
  std::set<std::array<int, 3>> ring;
  for (int i = 0; i < 9; ++i)
    if (i != 4) ring.insert({i / 3, i % 3, 0});
  CHECK(counts_of(cells(ring, 1), .2) == only_creases(24, 0, 16));
  CHECK(counts_of(cells(ring, 6), .2) == only_creases(24, 0, 16));
}

TEST_CASE("curves: the rims of a round hole in a plate are loops", "[curves][unit]") {
  for (const uint32_t m : {4, 8, 16}) CHECK(counts_of(plate_with_round_hole(m), .6) == only_creases(14, 2, 8));
}

TEST_CASE("curves: a cylinder has two rims, and sides where they turn by more than 40 degrees or are wide",
          "[curves][unit]") {
  for (const uint32_t layers : {1, 8})
    for (const double h : {.1, .3, .6}) {
      INFO(layers << " layers, edge length " << h);
      for (const uint32_t segments : {12, 16, 24, 32, 64}) {
        INFO(segments << " segments");
        const bool is_wide = 2 * std::sin(kTau / 2 / segments) >= 0.85 * h;
        const auto expected = is_wide ? only_creases(3 * segments, 0, 2 * segments) : only_creases(2, 2, 0);
        CHECK(counts_of(cylinder(segments, layers, 3), h) == expected);
        CHECK(counts_of(turned(cylinder(segments, layers, 3)), h) == expected);
      }
      CHECK(counts_of(cylinder(8, layers, 3), h) == only_creases(24, 0, 16));
    }
}

TEST_CASE("curves: a cut cone has two rims", "[curves][unit]") {
  for (const uint32_t segments : {16, 32, 64})
    CHECK(counts_of(cylinder(segments, 6, 2, .4), .25) == only_creases(2, 2, 0));
}

TEST_CASE("curves: a wedge of twenty degrees has nine creases", "[curves][unit]") {
  TriangleSoup soup;
  const double x = std::cos(kTau / 18), y = std::sin(kTau / 18);
  for (const double z : {0., 1.}) soup.vertices.insert(soup.vertices.end(), {{0, 0, z}, {x, 0, z}, {x, y, z}});
  soup.triangles = {{0, 2, 1}, {3, 4, 5}, {0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}, {2, 0, 3}, {2, 3, 5}};
  CHECK(counts_of(soup, .1) == only_creases(9, 0, 6));
}

TEST_CASE("curves: the border of a sheet has the corners of the sheet, and that of a disk none", "[curves][unit]") {
  for (const int n : {2, 4, 10, 40}) CHECK(counts_of(sheet(n, n, 2. / n), .2) == Counts{0, 4, 0, 0, 4});

  TriangleSoup disk = cylinder(32, 1, 1);
  disk.triangles.resize(disk.triangles.size() - 32);  // without its upper end
  disk.triangles.erase(disk.triangles.begin(), disk.triangles.begin() + 64);
  CHECK(counts_of(disk, .2) == Counts{0, 1, 0, 1, 0});
  const CurveNetwork network = curves_of(disk, .2);
  const std::vector<uint32_t>& v = network.curves[0].vertex;
  CHECK(v.size() == 32);
  CHECK(v[0] == *std::min_element(v.begin(), v.end()));
  CHECK(v[1] < v.back());
}

TEST_CASE("curves: teeth of a jagged border are no corners, those of long teeth and of battlements are",
          "[curves][unit]") {
  // A fan around the origin, whose rim goes in and out: by every vertex, or by two and two.
  const auto rim = [](uint32_t count, const std::function<bool(uint32_t)>& is_out, double depth) {
    TriangleSoup soup;
    soup.vertices.push_back({0, 0, 0});
    for (uint32_t i = 0; i < count; ++i) {
      const double r = is_out(i) ? 1 + depth : 1, turn = kTau * i / count;
      soup.vertices.push_back({r * std::cos(turn), r * std::sin(turn), 0});
    }
    for (uint32_t i = 0; i < count; ++i) shapes::add_triangle(soup, 0, 1 + i, 1 + (i + 1) % count);
    return soup;
  };
  const auto corners = [](const TriangleSoup& soup, double edge_length) {
    return find_curves(weld_for_features(soup), {CreaseMode::off, 0, edge_length}).corners.size();
  };
  const auto every_other = [](uint32_t i) { return i % 2 == 0; };
  const auto two_and_two = [](uint32_t i) { return i % 4 < 2; };
  CHECK(corners(rim(64, every_other, .1), .06) == 0);
  CHECK(corners(rim(64, every_other, .1), .02) == 64);
  CHECK(corners(rim(64, two_and_two, .3), .06) == 64);
}

TEST_CASE("curves: an edge of three triangles is a curve, and borders end where it does", "[curves][unit]") {
  TriangleSoup soup;
  soup.vertices = {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {1, 0, 1}, {-1, 1, 0}, {-1, 1, 1}, {-1, -1, 0}, {-1, -1, 1}};
  for (const uint32_t page : {2, 4, 6}) {
    shapes::add_triangle(soup, 0, page, page + 1);
    shapes::add_triangle(soup, 0, page + 1, 1);
  }
  CHECK(counts_of(soup, .1) == Counts{0, 9, 1, 0, 8});
}

TEST_CASE("curves: they do not depend on the order of vertices and triangles", "[curves][unit]") {
  for (const TriangleSoup& soup : {shaken(cube(12), .1 / 12), cylinder(20, 5, 2), plate_with_round_hole(6),
                                   shapes::random_soup(300, 1, .4, 5), sheet(9, 7, .25, 70)}) {
    const FeatureMesh mesh = weld_for_features(soup), other = weld_for_features(shapes::shuffled(soup, 11));
    const CurveNetwork network = curves_of(soup, .15), again = curves_of(shapes::shuffled(soup, 11), .15);
    CHECK(places_of(mesh, network) == places_of(other, again));
    CHECK(network.corners == again.corners);
  }
}

TEST_CASE("curves: an edge length or an angle that cannot be is refused", "[curves][unit]") {
  const FeatureMesh mesh = weld_for_features(cube(1));
  CHECK_THROWS_AS(find_curves(mesh, {CreaseMode::automatic, 0, 0}), Error);
  CHECK_THROWS_AS(find_curves(mesh, {CreaseMode::automatic, 0, NAN}), Error);
  CHECK_THROWS_AS(find_curves(mesh, {CreaseMode::threshold, 0, 1}), Error);
  CHECK_THROWS_AS(find_curves(mesh, {CreaseMode::threshold, 181, 1}), Error);
  CHECK(counts_of(find_curves({}, {CreaseMode::automatic, 0, 1})) == Counts{});
}
