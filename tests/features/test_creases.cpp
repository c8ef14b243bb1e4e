// Which edges are creases: of facets, round shapes and scans, by a threshold, and where patches are small.
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "features/curves/crease_gaps.h"
#include "features/curves/creases.h"
#include "features/curves/face_normals.h"
#include "features/known_curves.h"
#include "geometry/half_edges.h"
#include "isoshell/io/mesh_file.h"
#include "support/catch.h"
#include "support/source_folder.h"

using namespace isoshell;
using namespace isoshell::known_curves;

TEST_CASE("curves: a turn of degrees is one minus the cosine", "[curves][unit]") {
  for (int degrees = 0; degrees <= 180; degrees += 5)
    CHECK(turn_of_degrees(degrees) == Approx(1 - std::cos(degrees * kTau / 360)).margin(1e-14));
}

TEST_CASE("curves: edges between facets as wide as edges of the result are curves", "[curves][unit]") {
  const FeatureMesh mesh = weld_for_features(cylinder(24, 3, 2));  // facets .26 wide, which turn by 15 degrees
  CHECK(find_curves(mesh, {CreaseMode::automatic, 40, 0.2}).curves.size() == 24 + 2 * 24);
  CHECK(find_curves(mesh, {CreaseMode::automatic, 40, 0.4}).curves.size() == 2);
  const FeatureMesh cone = weld_for_features(cylinder(24, 3, 2, 0.5));  // facets that are too narrow on top
  CHECK(find_curves(cone, {CreaseMode::automatic, 40, 0.2}).curves.size() == 2);
}

TEST_CASE("curves: an edge is on one curve where edges between facets go on from a crease", "[curves][unit]") {
  // Flattened and drawn out: its long edges are creases here and there.
  TriangleSoup ring = shapes::torus(2, 0.8, 32, 8);
  for (WorldPoint& p : ring.vertices) p = {1.8 * p.x, 0.65 * p.y, 0.7 * p.z};
  const FeatureMesh mesh = weld_for_features(ring);
  for (const double length : {0.05, 0.1, 0.15, 0.2, 0.3}) {
    std::vector<uint64_t> edges;
    for (const FeatureCurve& curve : find_curves(mesh, {CreaseMode::automatic, 40, length}).curves)
      for (size_t i = 0; i + (curve.is_loop ? 0 : 1) < curve.vertex.size(); ++i)
        edges.push_back(edge_key(curve.vertex[i], curve.vertex[(i + 1) % curve.vertex.size()]));
    std::sort(edges.begin(), edges.end());
    CHECK(std::adjacent_find(edges.begin(), edges.end()) == edges.end());
  }
}

TEST_CASE("curves: the facets of a round shape of triangles have none", "[curves][unit]") {
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 12);  // edges that turn by up to 15 degrees
  CHECK(find_curves(weld_for_features(ball), {CreaseMode::automatic, 40, 0.05}).curves.empty());
}

TEST_CASE("curves: spheres have none, smooth or with bumps", "[curves][unit]") {
  for (const uint32_t n : {16, 24, 64, 128}) {
    const TriangleSoup sphere = shapes::sphere({0, 0, 0}, 1, n);
    const TriangleSoup bumpy = moved(sphere, [](const WorldPoint& p) {
      return (1 + .08 * std::sin(9 * p.x) * std::sin(8 * p.y + 1) * std::sin(9 * p.z)) * p;
    });
    for (const double h : {.05, .1, .3}) {
      INFO(n << " meridians, edge length " << h);
      CHECK(counts_of(sphere, h) == Counts{});
      CHECK(counts_of(bumpy, h) == Counts{});
      CHECK(counts_of(shaken(sphere, .3 / n), h) == Counts{});
    }
  }
}

TEST_CASE("curves: a scan has no creases", "[curves][unit]") {
  const FeatureMesh scan = weld_for_features(read_mesh(source_folder() + "/tests/data/nefertiti.ply"));
  double area = 0;
  for (const auto& t : scan.triangles)
    area += triangle_area(scan.vertices[t[0]], scan.vertices[t[1]], scan.vertices[t[2]]);
  for (const double vertices : {300., 1000., 10000., 100000.}) {
    INFO(vertices << " vertices");
    CreaseReport report;
    const CurveNetwork network =
        find_curves(scan, {CreaseMode::automatic, 0, std::sqrt(1.1547 * area / vertices)}, &report);
    CHECK(counts_of(network).creases == 0);
    CHECK(report.candidate_length_world > 0);
    CHECK(report.kept_length_world == 0);
  }
}

TEST_CASE("curves: an edge between a flat side and a round one is a crease, however far the round one turns",
          "[curves][unit]") {
  TriangleSoup soup = cylinder(32, 1, 6);  // a half of it, closed by a flat side
  for (WorldPoint& p : soup.vertices) p.x = std::max(p.x, 0.);
  CHECK(counts_of(soup, 2).creases == 6);
}

TEST_CASE("curves: a part with a rough place keeps its long sharp creases, one that is rough all over has none",
          "[curves][unit]") {
  constexpr double length = .15;
  const TriangleSoup part = cylinder(128, 42, 2), rough = shaken(part, .02);
  TriangleSoup in_part = part;  // on a third of its round side
  for (size_t v = 0; v < part.vertices.size(); ++v) {
    const WorldPoint& p = part.vertices[v];
    if (p.z > .3 && p.z < 1.7 && std::abs(std::atan2(p.y, p.x)) < 1) in_part.vertices[v] = rough.vertices[v];
  }
  const FeatureMesh mesh = weld_for_features(in_part);
  double loops_world = 0;
  for (const FeatureCurve& curve : find_curves(mesh, {CreaseMode::automatic, 0, length}).curves)
    for (size_t i = 0; curve.is_loop && i < curve.vertex.size(); ++i)
      loops_world +=
          isoshell::length(mesh.vertices[curve.vertex[(i + 1) % curve.vertex.size()]] - mesh.vertices[curve.vertex[i]]);
  CHECK(loops_world == Approx(2 * kTau).epsilon(.01));
  CHECK(curves_of(rough, length).curves.empty());
}

TEST_CASE("curves: creases between single small triangles say nothing of the surface, and are kept with the others",
          "[curves][unit]") {
  // A plate, 8 x 8 x 1, with pyramids on some of the unit squares on top, which have more length than a third of the
  // rest.
  TriangleSoup soup;
  constexpr uint32_t n = 8;
  for (const double z : {0., 1.})
    for (uint32_t i = 0; i <= n; ++i)
      for (uint32_t j = 0; j <= n; ++j) soup.vertices.push_back({double(i), double(j), z});
  const auto at = [&](uint32_t layer, uint32_t i, uint32_t j) { return (layer * (n + 1) + i) * (n + 1) + j; };
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    shapes::add_triangle(soup, a, b, c);
    shapes::add_triangle(soup, a, c, d);
  };
  size_t pyramids = 0;
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      quad(at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1), at(0, i + 1, j));
      const std::array<uint32_t, 4> top{at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1), at(1, i, j + 1)};
      if (i % 2 == 0 || j % 2 == 0 || i == 7 || j == 7) {
        quad(top[0], top[1], top[2], top[3]);
        continue;
      }
      const auto apex = uint32_t(soup.vertices.size());
      soup.vertices.push_back({i + .5, j + .5, 2});
      for (size_t k = 0; k < 4; ++k) shapes::add_triangle(soup, top[k], top[(k + 1) % 4], apex);
      ++pyramids;
    }
  for (uint32_t i = 0; i < n; ++i) {
    quad(at(0, i, 0), at(0, i + 1, 0), at(1, i + 1, 0), at(1, i, 0));
    quad(at(0, i + 1, n), at(0, i, n), at(1, i, n), at(1, i + 1, n));
    quad(at(0, 0, i + 1), at(0, 0, i), at(1, 0, i), at(1, 0, i + 1));
    quad(at(0, n, i), at(0, n, i + 1), at(1, n, i + 1), at(1, n, i));
  }
  CreaseReport report;
  find_curves(weld_for_features(soup), {CreaseMode::automatic, 0, 2}, &report);
  const double slanted = 4 * std::sqrt(1.5) * double(pyramids), others = 8 * 8 + 4 + 4 * double(pyramids);
  REQUIRE(others < .75 * (others + slanted));
  CHECK(report.candidate_length_world == Approx(others + slanted));
  CHECK(report.components_without_creases == 0);
}

TEST_CASE("curves: the threshold decides which bend is a crease", "[curves][unit]") {
  const FeatureMesh mesh = weld_for_features(sheet(8, 8, .25, 25));
  CHECK(counts_of(find_curves(mesh, {CreaseMode::threshold, 24, .1})) == Counts{1, 6, 0, 0, 6});
  CHECK(counts_of(find_curves(mesh, {CreaseMode::threshold, 26, .1})) == Counts{0, 4, 0, 0, 4});
  CHECK(counts_of(find_curves(weld_for_features(cube(3)), {CreaseMode::off, 0, .1})) == Counts{});
}

TEST_CASE("curves: where so many vertices are too few for all creases, the shortest of those as sharp are left out",
          "[curves][unit]") {
  std::set<std::array<int, 3>> plate_with_bump{{1, 1, 1}};
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y) plate_with_bump.insert({x, y, 0});
  const FeatureMesh mesh = weld_for_features(cells(plate_with_bump, 2));
  CurveOptions options{CreaseMode::threshold, 40, .7};  // a face of the bump has 4 of border, a side of the plate 10
  const auto length_on = [&](const CurveNetwork& network, bool is_plate) {
    double sum = 0;
    for (const FeatureCurve& curve : network.curves)
      for (size_t i = 1; i < curve.vertex.size(); ++i) {
        const WorldPoint &a = mesh.vertices[curve.vertex[i - 1]], &b = mesh.vertices[curve.vertex[i]];
        const auto is_outside = [](const WorldPoint& p) { return p.x == 0 || p.x == 4 || p.y == 0 || p.y == 4; };
        if ((is_outside(a) && is_outside(b)) == is_plate) sum += std::sqrt(distance_sq(a, b));
      }
    return sum;
  };
  const CurveNetwork all = find_curves(mesh, options);
  CHECK(length_on(all, true) == Approx(36));
  CHECK(length_on(all, false) == Approx(12));
  options.most_vertices = (36 + 6) / .7;
  const CurveNetwork fewer = find_curves(mesh, options);
  CHECK(length_on(fewer, true) >= 8 * 4);  // those as short as the bump's may go
  CHECK(length_on(fewer, false) < 10);
  CHECK(length_on(fewer, true) + length_on(fewer, false) > 40);
}

TEST_CASE("curves: edges said to be smooth are no creases, borders stay what they are", "[curves][unit]") {
  const FeatureMesh mesh = weld_for_features(cube(2));
  CurveOptions options{CreaseMode::threshold, 40, .1};
  for (const FeatureCurve& curve : find_curves(mesh, options).curves)
    for (size_t i = 1; i < curve.vertex.size(); ++i)
      if (mesh.vertices[curve.vertex[i]].z == mesh.vertices[curve.vertex[i - 1]].z)
        options.smooth.push_back({curve.vertex[i], curve.vertex[i - 1]});
  CHECK(find_curves(mesh, options).curves.size() == 4);
  const FeatureMesh flat = weld_for_features(sheet(4, 4, .25, 25));
  CurveOptions of_flat{CreaseMode::threshold, 26, .1};
  const CurveNetwork borders = find_curves(flat, of_flat);
  for (const FeatureCurve& curve : borders.curves) of_flat.smooth.push_back({curve.vertex[0], curve.vertex[1]});
  CHECK(find_curves(flat, of_flat).curves.size() == borders.curves.size());
}

TEST_CASE("curves: a crease that is interrupted for less than an edge goes on, by its own edges", "[curves][unit]") {
  const FeatureMesh mesh = weld_for_features(cube(8));
  const MeshEdges edges = find_mesh_edges(mesh);
  const std::vector<CurveEdge> all = with_creases_above(mesh, edges, find_fixed_curve_edges(edges), 45);
  REQUIRE(all.size() == 12 * 8);
  Buffer<double> turns(edges.count());
  for (uint32_t e = 0; e < edges.count(); ++e) turns[e] = 0;
  for (const CurveEdge& c : all) turns[c.edge] = c.turn;
  const auto on_line = [&](uint32_t e, double from, double to) {  // along x, where y and z are 0
    const WorldPoint &a = mesh.vertices[edges.edges[e].end[0]], &b = mesh.vertices[edges.edges[e].end[1]];
    const auto is_on = [](const WorldPoint& p) { return p.y == 0 && p.z == 0; };
    return is_on(a) && is_on(b) && std::min(a.x, b.x) >= from && std::max(a.x, b.x) <= to;
  };
  const auto across = [&](double from, double to, double reach) {
    std::vector<uint32_t> gone;
    std::vector<CurveEdge> left;
    for (const CurveEdge& c : all)
      if (on_line(c.edge, from, to))
        gone.push_back(c.edge);
      else
        left.push_back(c);
    const std::vector<uint32_t> found = edges_across_gaps(mesh, edges, turns.view(), left, reach);
    return std::pair(found == gone, found.empty());
  };
  CHECK(across(.25, .5, .3).first);           // between two ends
  CHECK(across(.75, 1, .3).first);            // up to a corner
  CHECK(across(.25, .625, .3).second);        // too wide
  CHECK(across(0, 1, 2).second);              // nothing ends freely
  std::fill(turns.begin(), turns.end(), 0.);  // flat edges count twice
  CHECK(across(.25, .5, .3).second);
  CHECK(across(.25, .5, .6).first);
}

TEST_CASE("curves: creases that end beside each other, and do not lead there, stay as they are", "[curves][unit]") {
  const FeatureMesh mesh = weld_for_features(cube(8));
  const MeshEdges edges = find_mesh_edges(mesh);
  std::vector<CurveEdge> two;  // half of the edges along x at y = 0 and y = 1, where z is 0: side by side, far apart
  for (uint32_t e = 0; e < edges.count(); ++e) {
    const WorldPoint &a = mesh.vertices[edges.edges[e].end[0]], &b = mesh.vertices[edges.edges[e].end[1]];
    if (a.z == 0 && b.z == 0 && a.y == b.y && (a.y == .25 || a.y == .5) && std::max(a.x, b.x) <= .5)
      two.push_back({e, CurveKind::crease, 1});
  }
  REQUIRE(two.size() == 8);
  Buffer<double> turns(edges.count());
  for (uint32_t e = 0; e < edges.count(); ++e) turns[e] = 1;
  CHECK(edges_across_gaps(mesh, edges, turns.view(), two, .45).empty());
}
