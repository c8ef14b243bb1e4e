// Borders, creases and corners of shapes whose curves are known.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <ostream>
#include <set>

#include "core/half_edge_list.h"
#include "core/world_vector.h"
#include "features/face_normals.h"
#include "features/find_curves.h"
#include "features/weld_for_features.h"
#include "isoshell/error.h"
#include "isoshell/io/mesh_file.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/source_folder.h"

using namespace isoshell;

namespace {

constexpr double kTau = 6.283185307179586;

/// The surface of unit cells, each side of a cell in n x n squares.
TriangleSoup cells(const std::set<std::array<int, 3>>& solid, int n) {
  TriangleSoup soup;
  for (const auto& cell : solid)
    for (int axis = 0; axis < 3; ++axis)
      for (int side = 0; side < 2; ++side) {
        auto beyond = cell;
        beyond[size_t(axis)] += side ? 1 : -1;
        if (solid.count(beyond)) continue;
        const auto corner = [&](int i, int j) {
          double at[3] = {double(cell[0]), double(cell[1]), double(cell[2])};
          at[axis] += side;
          at[(axis + 1) % 3] += double(i) / n;
          at[(axis + 2) % 3] += double(j) / n;
          soup.vertices.push_back({at[0], at[1], at[2]});
          return uint32_t(soup.vertices.size() - 1);
        };
        for (int i = 0; i < n; ++i)
          for (int j = 0; j < n; ++j) {
            const uint32_t a = corner(i, j), b = corner(i + 1, j), c = corner(i + 1, j + 1), d = corner(i, j + 1);
            shapes::add_triangle(soup, a, side ? b : c, side ? c : b);
            shapes::add_triangle(soup, a, side ? c : d, side ? d : c);
          }
      }
  return soup;
}
TriangleSoup cube(int n) { return cells({{0, 0, 0}}, n); }

/// A closed body between z = 0 and z = height over a regular polygon, wider or narrower on top.
TriangleSoup cylinder(uint32_t segments, uint32_t layers, double height, double radius_on_top = 1) {
  TriangleSoup soup;
  for (uint32_t k = 0; k <= layers; ++k)
    for (uint32_t i = 0; i < segments; ++i) {
      const double r = 1 + (radius_on_top - 1) * k / layers;
      soup.vertices.push_back(
          {r * std::cos(kTau * i / segments), r * std::sin(kTau * i / segments), height * k / layers});
    }
  const auto at = [&](uint32_t k, uint32_t i) { return k * segments + i % segments; };
  for (uint32_t i = 0; i < segments; ++i)
    for (uint32_t k = 0; k < layers; ++k) {
      shapes::add_triangle(soup, at(k, i), at(k, i + 1), at(k + 1, i + 1));
      shapes::add_triangle(soup, at(k, i), at(k + 1, i + 1), at(k + 1, i));
    }
  for (const bool is_top : {false, true}) {
    const auto centre = uint32_t(soup.vertices.size());
    const uint32_t k = is_top ? layers : 0;
    soup.vertices.push_back({0, 0, is_top ? height : 0});
    for (uint32_t i = 0; i < segments; ++i)
      shapes::add_triangle(soup, centre, at(k, is_top ? i : i + 1), at(k, is_top ? i + 1 : i));
  }
  return soup;
}

/// A square plate, 4 wide, with a round hole of radius 1 in 4 m segments.
TriangleSoup plate_with_round_hole(uint32_t m) {
  TriangleSoup soup;
  const uint32_t n = 4 * m;
  for (const double z : {0., .5})
    for (const bool is_outer : {false, true})
      for (uint32_t i = 0; i < n; ++i) {
        const double x = std::cos(kTau * (i + .5 * m) / n), y = std::sin(kTau * (i + .5 * m) / n);
        double s = 1;
        if (is_outer) s = 2 / std::max(std::abs(x), std::abs(y));
        const bool is_corner = is_outer && i % m == 0;
        soup.vertices.push_back(is_corner ? WorldPoint{x < 0 ? -2. : 2., y < 0 ? -2. : 2., z}
                                          : WorldPoint{s * x, s * y, z});
      }
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    shapes::add_triangle(soup, a, b, c);
    shapes::add_triangle(soup, a, c, d);
  };
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t j = (i + 1) % n;
    quad(i, j, n + j, n + i);                          // below
    quad(2 * n + j, 2 * n + i, 3 * n + i, 3 * n + j);  // above
    quad(j, i, 2 * n + i, 2 * n + j);                  // in the hole
    quad(n + i, n + j, 3 * n + j, 3 * n + i);          // around
  }
  return soup;
}

/// n x m squares of this step, bent along the middle by so many degrees.
TriangleSoup sheet(int n, int m, double step, double degrees = 0) {
  TriangleSoup soup;
  const double turn = degrees * kTau / 360;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= m; ++j) {
      const double x = (i - n / 2) * step, y = j * step;
      soup.vertices.push_back(x <= 0 ? WorldPoint{x, y, 0} : WorldPoint{x * std::cos(turn), y, x * std::sin(turn)});
    }
  const auto at = [&](int i, int j) { return uint32_t(i * (m + 1) + j); };
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < m; ++j) {
      shapes::add_triangle(soup, at(i, j), at(i + 1, j), at(i + 1, j + 1));
      shapes::add_triangle(soup, at(i, j), at(i + 1, j + 1), at(i, j + 1));
    }
  return soup;
}

/// Every position after a map that takes equal positions to equal ones.
TriangleSoup moved(TriangleSoup soup, const std::function<WorldPoint(const WorldPoint&)>& map) {
  for (WorldPoint& p : soup.vertices) p = map(p);
  return soup;
}
TriangleSoup turned(TriangleSoup soup) {
  const double a = .7137, b = 1.1923;
  return moved(std::move(soup), [=](const WorldPoint& p) {
    const double x = std::cos(a) * p.x - std::sin(a) * p.y, y = std::sin(a) * p.x + std::cos(a) * p.y;
    return WorldPoint{x, std::cos(b) * y - std::sin(b) * p.z, std::sin(b) * y + std::cos(b) * p.z};
  });
}
/// Every coordinate off by at most so much, at random.
TriangleSoup shaken(TriangleSoup soup, double most) {
  std::map<std::array<double, 3>, uint64_t> number;
  return moved(std::move(soup), [&, most](const WorldPoint& p) {
    const uint64_t n = number.insert({{p.x, p.y, p.z}, number.size()}).first->second;
    const auto off = [&](uint64_t axis) {
      return most * (2 * double(random_bits(7, 3 * n + axis) >> 11) / 9007199254740992.0 - 1);
    };
    return WorldPoint{p.x + off(0), p.y + off(1), p.z + off(2)};
  });
}

CurveNetwork curves_of(const TriangleSoup& soup, double edge_length_world) {
  return find_curves(weld_for_features(soup), {CreaseMode::automatic, 0, edge_length_world});
}

struct Counts {
  int64_t creases = 0, borders = 0, non_manifold = 0, loops = 0, corners = 0;
  bool operator==(const Counts& o) const {
    return creases == o.creases && borders == o.borders && non_manifold == o.non_manifold && loops == o.loops &&
           corners == o.corners;
  }
};
std::ostream& operator<<(std::ostream& out, const Counts& c) {
  return out << c.creases << " creases, " << c.borders << " borders, " << c.non_manifold << " non-manifold, " << c.loops
             << " loops, " << c.corners << " corners";
}

Counts counts_of(const CurveNetwork& network) {
  Counts n;
  for (const FeatureCurve& c : network.curves) {
    n.creases += c.kind == CurveKind::crease;
    n.borders += c.kind == CurveKind::border;
    n.non_manifold += c.kind == CurveKind::non_manifold;
    n.loops += c.is_loop;
  }
  n.corners = int64_t(network.corners.size());
  return n;
}
Counts counts_of(const TriangleSoup& soup, double edge_length_world) {
  return counts_of(curves_of(soup, edge_length_world));
}
Counts only_creases(int64_t creases, int64_t loops, int64_t corners) { return {creases, 0, 0, loops, corners}; }

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

TEST_CASE("curves: a turn of degrees is one minus the cosine", "[curves][unit]") {
  for (int degrees = 0; degrees <= 180; degrees += 5)
    CHECK(turn_of_degrees(degrees) == Approx(1 - std::cos(degrees * kTau / 360)).margin(1e-14));
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

TEST_CASE("curves: the threshold decides which bend is a crease", "[curves][unit]") {
  const FeatureMesh mesh = weld_for_features(sheet(8, 8, .25, 25));
  CHECK(counts_of(find_curves(mesh, {CreaseMode::threshold, 24, .1})) == Counts{1, 6, 0, 0, 6});
  CHECK(counts_of(find_curves(mesh, {CreaseMode::threshold, 26, .1})) == Counts{0, 4, 0, 0, 4});
  CHECK(counts_of(find_curves(weld_for_features(cube(3)), {CreaseMode::off, 0, .1})) == Counts{});
}

TEST_CASE("curves: patches too small for the edges lose sharp creases, too, where that is asked for, others none",
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
  options.drops_small_patches = true;
  const CurveNetwork fewer = find_curves(mesh, options);
  CHECK(length_on(fewer, true) == Approx(36));
  CHECK(length_on(fewer, false) < 10);
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
