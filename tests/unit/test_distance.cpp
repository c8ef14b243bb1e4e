// Distances between meshes whose distances are known by hand, or found by looking at every triangle.
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/triangle_grid.h"
#include "geometry/turn.h"
#include "geometry/world_vector.h"
#include "isoshell/distance.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

/// Two triangles at the height z.
TriangleMesh square(double size, double z) {
  return {{{0, 0, z}, {size, 0, z}, {size, size, z}, {0, size, z}}, {{{0, 1, 2}}, {{0, 2, 3}}}};
}

MeshDistance distance(const TriangleMesh& mesh, const TriangleMesh& reference, int threads = 0,
                      const DistanceOptions& options = {}) {
  Context context;
  context.threads = threads;
  return measure_distance(mesh, reference, context, options);
}

constexpr DistanceOptions kExact{20000, true};

/// Numbers from 0 to 1, one after the other.
class Random {
 public:
  explicit Random(uint64_t seed) : seed_(seed) {}
  double operator()() { return double(random_bits(seed_, next_++) >> 11) / double(uint64_t(1) << 53); }
  WorldPoint point() { return {(*this)(), (*this)(), (*this)()}; }

 private:
  uint64_t seed_, next_ = 0;
};

double to_segment(WorldPoint p, WorldPoint a, WorldPoint b) {
  const double size_sq = length_sq(b - a), part = size_sq > 0 ? dot(p - a, b - a) / size_sq : 0;
  return length(p - (a + std::clamp(part, 0., 1.) * (b - a)));
}

/// By thirds: over segments parallel to the side from a to b the distance has one valley. No plane is asked for, so a
/// triangle may be as flat as it will.
double to_triangle(WorldPoint p, WorldPoint a, WorldPoint b, WorldPoint c) {
  const auto at = [&](double part) { return to_segment(p, a + part * (c - a), b + part * (c - b)); };
  double from = 0, to = 1;
  for (int i = 0; i < 100; ++i) {
    const double third = (to - from) / 3, left = from + third, right = to - third;
    (at(left) <= at(right) ? to : from) = at(left) <= at(right) ? right : left;
  }
  return std::min({at(from), at(0), at(1)});
}

double to_mesh(WorldPoint p, const TriangleMesh& mesh) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles)
    least = std::min(least, to_triangle(p, mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]));
  return least;
}

/// A triangle of edges of about 1; its third corner lies so far from the line of two others.
TriangleMesh flat_triangle(double height, Random& random) {
  const WorldPoint a = random.point(), along = random.point();
  std::array<WorldPoint, 3> corners{a, a + along, a + random() * along + height * random.point()};
  std::rotate(corners.begin(), corners.begin() + int(3 * random()), corners.end());
  return {{corners.begin(), corners.end()}, {{{0, 1, 2}}}};
}

/// `count` triangles here and there in a cube, flat ones among them.
TriangleMesh random_mesh(int count, Random& random) {
  TriangleMesh mesh;
  for (int i = 0; i < count; ++i) {
    const TriangleMesh one = flat_triangle(std::pow(10, -12 * random()), random);
    const auto first = uint32_t(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), one.vertices.begin(), one.vertices.end());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

/// The farthest of points of a mesh from another one, and how far they are from their neighbours.
struct Farthest {
  double distance = 0, step = 0;
};
Farthest farthest_sample(const TriangleMesh& mesh, const TriangleMesh& to, int parts) {
  Farthest found;
  for (const auto& t : mesh.triangles) {
    const WorldPoint a = mesh.vertices[t[0]], b = mesh.vertices[t[1]] - a, c = mesh.vertices[t[2]] - a;
    found.step = std::max(found.step, std::max({length(b), length(c), length(c - b)}) / parts);
    for (int i = 0; i <= parts; ++i)
      for (int j = 0; i + j <= parts; ++j)
        found.distance = std::max(found.distance, to_mesh(a + double(i) / parts * b + double(j) / parts * c, to));
  }
  return found;
}

}  // namespace

TEST_CASE("distance: a mesh is at distance zero of itself", "[distance][unit]") {
  const TriangleMesh torus = mesh_of(shapes::torus(2, 0.7, 60, 30));
  const MeshDistance d = distance(torus, torus);
  CHECK(d.to_reference.mean == Approx(0).margin(1e-7));
  CHECK(d.largest() == Approx(0).margin(1e-7));
}

TEST_CASE("distance: spheres of two radii are apart by their difference", "[distance][unit]") {
  const MeshDistance d =
      distance(mesh_of(shapes::sphere({0, 0, 0}, 1.1, 60)), mesh_of(shapes::sphere({0, 0, 0}, 1, 60)));
  CHECK(d.to_reference.mean == Approx(0.1).epsilon(0.03));
  CHECK(d.to_reference.rms >= d.to_reference.mean);
  CHECK(d.to_reference.max >= d.to_reference.rms);
  CHECK(d.from_reference.max == Approx(0.1).epsilon(0.03));
  CHECK(d.diagonal == Approx(2 * std::sqrt(3.0)).epsilon(0.01));
}

TEST_CASE("distance: what only one of two meshes has shows in one direction", "[distance][unit]") {
  const MeshDistance d = distance(square(1, 0), square(3, 0));
  CHECK(d.to_reference.max == Approx(0).margin(1e-12));
  CHECK(d.from_reference.max == Approx(2 * std::sqrt(2.0)));
  CHECK(d.largest() == d.from_reference.max);
}

TEST_CASE("distance: that of points is the one to the nearest triangle, whatever the threads", "[distance][unit]") {
  const TriangleMesh mesh = square(1, 0);
  const std::vector<WorldPoint> points = {{0.5, 0.5, 2}, {2, 0.5, 0}, {4, 5, 0}, {0.25, 0.75, 0}};
  for (const int threads : {1, 2}) {
    Context context;
    context.threads = threads;
    CHECK(distances(points, mesh, context) == std::vector<double>{2, 1, 5, 0});
  }
  Context context;
  CHECK(distances({}, mesh, context).empty());
  CHECK_THROWS_AS(distances(points, {}, context), Error);
}

TEST_CASE("distance: samples weigh areas, not triangles", "[distance][unit]") {
  TriangleMesh mesh = square(1, 0);  // and a thousand small triangles far up, a millionth of its area
  for (uint32_t i = 0; i < 1000; ++i) {
    const double x = i * 1e-3, size = 4e-5;
    const auto first = uint32_t(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {{x, 0, 1}, {x + size, 0, 1}, {x, size, 1}});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  const MeshDistance d = distance(mesh, square(1, 0));
  CHECK(d.to_reference.mean < 1e-4);
  CHECK(d.to_reference.max == Approx(1));
}

TEST_CASE("distance: the grid of triangles finds what looking at each one finds", "[distance][unit]") {
  TriangleMesh target;  // small ones, long needles, one without area and one far away
  const auto at = [](uint64_t i) { return double(random_bits(5, i) >> 40) / double(1 << 24); };
  for (uint32_t i = 0; i < 300; ++i) {
    const double x = at(9 * i), y = at(9 * i + 1), z = at(9 * i + 2), size = i % 50 == 0 ? 3 : 0.05;
    target.vertices.push_back({x, y, z});
    target.vertices.push_back({x + size * at(9 * i + 3), y + size * at(9 * i + 4), z});
    target.vertices.push_back(i % 70 == 1 ? target.vertices.back()
                                          : WorldPoint{x + size * at(9 * i + 5), y, z + 0.05 * at(9 * i + 6)});
    target.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  target.vertices.insert(target.vertices.end(), {{20, 0, 0}, {21, 0, 0}, {20, 1, 0}});
  target.triangles.push_back({900, 901, 902});

  const TriangleGrid grid(target);
  for (uint64_t i = 0; i < 300; ++i) {  // near, between and beyond
    const WorldPoint p{30 * at(5000 + i) * at(6000 + i) - 2, 4 * at(7000 + i) - 2, 4 * at(8000 + i) - 2};
    double best = 1e30;
    for (const auto& t : target.triangles) {
      const TriangleMesh one{{target.vertices[t[0]], target.vertices[t[1]], target.vertices[t[2]]}, {{{0, 1, 2}}}};
      best = std::min(best, TriangleGrid(one).distance_sq(p));
    }
    CHECK(grid.distance_sq(p) == best);
  }
}

TEST_CASE("distance: the grid of triangles finds the nearest one from far away, and from inside of a hollow",
          "[distance][unit]") {
  const TriangleMesh ball = mesh_of(shapes::sphere({0, 0, 0}, 1, 120));
  const TriangleGrid grid(ball);
  for (uint64_t i = 0; i < 40; ++i) {
    const auto at = [&](uint64_t of) { return double(random_bits(of, i) >> 40) / double(1 << 23) - 1; };
    const WorldPoint direction{at(1), at(2), at(3)};
    const double size = length(direction);
    for (const double distance : {0., .1, .5, 1.5, 10., 1e6}) {
      const WorldPoint p = distance / size * direction;
      double best = 1e30;
      for (const auto& t : ball.triangles)
        best = std::min(
            best, nearest_of_triangle(p, ball.vertices[t[0]], ball.vertices[t[1]], ball.vertices[t[2]]).distance_sq);
      CHECK(grid.distance_sq(p) == best);
    }
  }
}

TEST_CASE("distance: angles are those of the arc tangent", "[distance][unit]") {
  for (int i = 0; i <= 100000; ++i) {
    const double x = i / 100000.;
    REQUIRE(std::abs(arc_tangent(x) - std::atan(x)) <= 1e-15 * x);
  }
  CHECK(angle_between_deg({1, 0, 0}, {5, 0, 0}) == 0);
  CHECK(angle_between_deg({1, 0, 0}, {-5, 0, 0}) == 0);
  CHECK(angle_between_deg({1, 0, 0}, {0, 3, 0}) == 90);
  CHECK(angle_between_deg({1, 0, 0}, {1, 1, 0}) == Approx(45).epsilon(1e-15));
  CHECK(angle_between_deg({0, 0, 1}, {0, 1, std::sqrt(3)}) == Approx(30).epsilon(1e-15));
  CHECK(angle_between_deg({0, 0, 0}, {0, 1, 0}) == 0);
}

TEST_CASE("distance: a mesh without triangles, or of vertices that are not there, is refused", "[distance][unit]") {
  CHECK_THROWS_AS(distance({}, square(1, 0)), Error);
  CHECK_THROWS_AS(distance(square(1, 0), {{{0, 0, 0}}, {{{0, 0, 1}}}}), Error);
}

TEST_CASE("distance: threads change nothing, and a cancelled context ends it", "[distance][unit]") {
  const TriangleMesh torus = mesh_of(shapes::torus(2, 0.7, 60, 30)), other = mesh_of(shapes::torus(2, 0.6, 50, 20));
  CHECK(distance(torus, other, 1).to_reference.mean == distance(torus, other, 3).to_reference.mean);
  Context cancelled;
  cancelled.cancel = true;
  CHECK_THROWS_AS(measure_distance(torus, other, cancelled), Error);
}

TEST_CASE("distance: normals of a mesh deviate from its own by nothing, beside creases, too", "[distance][unit]") {
  for (const TriangleSoup& soup : {shapes::torus(2, 0.7, 60, 30), shapes::box({0, 0, 0}, {1, 2, 3})}) {
    const MeshDistance d = distance(mesh_of(soup), mesh_of(soup));
    CHECK(d.normal_to_reference.mean_deg < 1e-6);
    CHECK(d.normal_to_reference.max_deg < 1e-5);
    CHECK(d.normal_from_reference.max_deg < 1e-5);
    CHECK(d.normal_deviation_deg() < 1e-6);
  }
}

TEST_CASE("distance: normals of a tilted square deviate by its tilt, whichever way it faces", "[distance][unit]") {
  TriangleMesh tilted = square(1, 0);
  for (WorldPoint& p : tilted.vertices) p.z = p.x * 0.5773502691896258;  // 30 degrees
  for (int turn = 0; turn < 2; ++turn) {
    const MeshDistance d = distance(tilted, square(3, -0.1));
    CHECK(d.normal_to_reference.mean_deg == Approx(30));
    CHECK(d.normal_to_reference.max_deg == Approx(30));
    CHECK(d.normal_from_reference.mean_deg == Approx(30));
    CHECK(d.normal_deviation_deg() == Approx(30));
    for (auto& t : tilted.triangles) std::swap(t[1], t[2]);
  }
}

TEST_CASE("distance: a rounded crease shows in the normals", "[distance][unit]") {
  const TriangleMesh box = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  TriangleMesh cut = box;  // the vertex at 1 1 1 moved inward
  cut.vertices[7] = {.8, .8, .8};
  const MeshDistance d = distance(cut, box);
  CHECK(d.normal_to_reference.max_deg > 10);
  CHECK(d.normal_from_reference.max_deg > 10);
  CHECK(d.normal_from_reference.mean_deg > 1);
  CHECK(d.normal_from_reference.mean_deg < 20);
  const MeshDistance one = distance(cut, box, 1);
  CHECK(one.normal_to_reference.mean_deg == d.normal_to_reference.mean_deg);
  CHECK(one.normal_from_reference.mean_deg == d.normal_from_reference.mean_deg);
}

TEST_CASE("distance: the largest one is found inside of a triangle, where it is asked for exactly",
          "[distance][unit]") {
  TriangleMesh posts;  // a point at each corner of the square, nearly
  for (const WorldPoint& p : square(2, 0).vertices) {
    const auto first = uint32_t(posts.vertices.size());
    posts.vertices.insert(posts.vertices.end(), {p, {p.x, p.y, 1e-9}, {p.x + 1e-9, p.y, 0}});
    posts.triangles.push_back({first, first + 1, first + 2});
  }
  for (const int threads : {1, 4}) {
    const OneSidedDistance d = distance(square(2, 0), posts, threads, kExact).to_reference;
    REQUIRE(d.at_most);
    CHECK(d.max == Approx(std::sqrt(2)).epsilon(2e-3));
    CHECK(d.max <= std::sqrt(2) + 1e-8);
    CHECK(*d.at_most >= std::sqrt(2) - 1e-8);
    CHECK(*d.at_most <= 1.003 * d.max);
  }
  CHECK_FALSE(distance(square(2, 0), posts).to_reference.at_most);
}

TEST_CASE("distance: no point of a mesh is farther than the exact bound says", "[distance][unit]") {
  const TriangleMesh torus = mesh_of(shapes::torus(2, 0.7, 40, 20)), other = mesh_of(shapes::torus(2.1, 0.6, 30, 14));
  const OneSidedDistance d = distance(torus, other, 1, kExact).to_reference,
                         same = distance(torus, other, 4, kExact).to_reference;
  REQUIRE(d.at_most);
  CHECK(d.max == same.max);
  CHECK(*d.at_most == *same.at_most);
  std::vector<WorldPoint> points;
  for (uint64_t i = 0; i < 200000; ++i) {
    const auto part = [&](uint64_t of) { return double(random_bits(of, i) >> 40) / double(1 << 24); };
    const auto& [a, b, c] = torus.triangles[size_t(i) % torus.triangles.size()];
    const double u = part(1), v = (1 - u) * part(2);
    const WorldPoint p = torus.vertices[a], q = torus.vertices[b], r = torus.vertices[c];
    points.push_back({p.x + u * (q.x - p.x) + v * (r.x - p.x), p.y + u * (q.y - p.y) + v * (r.y - p.y),
                      p.z + u * (q.z - p.z) + v * (r.z - p.z)});
  }
  Context context;
  const std::vector<double> found = distances(points, other, context);
  const double largest = *std::max_element(found.begin(), found.end());
  CHECK(largest <= *d.at_most);
  CHECK(d.max >= .998 * largest);
  CHECK(*d.at_most <= 1.003 * d.max);
}

TEST_CASE("distance: a mesh is nowhere away from itself, exactly", "[distance][unit]") {
  const TriangleMesh torus = mesh_of(shapes::torus(2, 0.7, 60, 30));
  const MeshDistance d = distance(torus, torus, 0, kExact);
  CHECK(d.to_reference.at_most.value() < 1e-8);
  CHECK(d.normal_to_reference.max_deg < 1e-5);
}

TEST_CASE("distance: beside a crease normals are those of the best aligned side, if it is as near",
          "[distance][unit]") {
  const TriangleMesh box = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1})),
                     larger = mesh_of(shapes::box({-.2, -.2, -.2}, {1.2, 1.2, 1.2}));
  CHECK(distance(larger, box, 0, kExact).normal_to_reference.max_deg < 1e-5);
  const MeshDistance self = distance(box, box, 0, kExact);
  CHECK(self.normal_to_reference.max_deg < 1e-5);
  CHECK(self.normal_from_reference.max_deg < 1e-5);
}

TEST_CASE("distance: no samples are refused", "[distance][unit]") {
  CHECK_THROWS_AS(distance(square(1, 0), square(1, 0), 0, {0, false}), Error);
}

TEST_CASE("distance: that to a triangle is the one to its nearest point, however flat it is", "[distance][unit]") {
  Random random(1);
  for (int i = 0; i < 20000; ++i) {
    const TriangleMesh flat = flat_triangle(std::pow(10, -16 * random()), random);
    const WorldPoint a = flat.vertices[0], b = flat.vertices[1], c = flat.vertices[2];
    const double b_part = random(), c_part = (1 - b_part) * random();
    const WorldPoint p = a + b_part * (b - a) + c_part * (c - a) + std::pow(10, -20 * random()) * random.point();
    const MeshPoint found = nearest_of_triangle(p, a, b, c);
    const double distance = std::sqrt(found.distance_sq), truth = to_triangle(p, a, b, c);
    const double at = length(p - (a + found.b_part * (b - a) + found.c_part * (c - a)));
    INFO(i << ": " << distance << " for " << truth << ", at a point " << at << " away");
    REQUIRE(std::abs(distance - truth) < 1e-11);
    REQUIRE(std::abs(at - truth) < 1e-11);
  }
}

TEST_CASE("distance: the largest one between random meshes is the true one within the bound, both ways",
          "[distance][unit]") {
  Random random(2);
  for (int i = 0; i < 20; ++i) {
    const TriangleMesh mesh = random_mesh(1 + i / 2, random), reference = random_mesh(1 + i % 5, random);
    const MeshDistance d = distance(mesh, reference, 1, {200, true});
    const auto check = [&](const OneSidedDistance& side, const Farthest& truth) {
      const double bound = std::max(2e-3 * side.max, 1e-9 * d.diagonal);
      INFO(i << ": " << side.max << " to " << *side.at_most << " for " << truth.distance << ", step " << truth.step);
      CHECK(side.max <= truth.distance + truth.step);
      CHECK(*side.at_most >= truth.distance - 1e-14);
      CHECK(*side.at_most <= side.max + bound);
    };
    check(d.to_reference, farthest_sample(mesh, reference, 24));
    check(d.from_reference, farthest_sample(reference, mesh, 24));
  }
}

TEST_CASE("distance: meshes of flat triangles are no farther from themselves than they were moved",
          "[distance][unit]") {
  Random random(3);
  const TriangleMesh mesh = random_mesh(300, random);
  for (const double by : {0., 1e-9, 1e-6, 1e-3}) {
    TriangleMesh moved = mesh;
    for (WorldPoint& p : moved.vertices) p = p + WorldPoint{0, by, 0};
    const MeshDistance d = distance(moved, mesh, 0, kExact);
    CHECK(d.largest() < by + 1e-11);
    CHECK(*d.to_reference.at_most <= d.to_reference.max + std::max(2e-3 * d.to_reference.max, 1e-9 * d.diagonal));
  }
}
