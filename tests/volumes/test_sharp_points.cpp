// Points of sharp bodies give their edges and corners; points of others give what they gave.
#include <tbb/global_control.h>

#include <cmath>
#include <cstring>

#include "geometry/world_vector.h"
#include "implicit/points/flat_normals.h"
#include "implicit/points/sides_of_points.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/io/point_file.h"
#include "support/catch.h"
#include "support/made_field.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

double unit(uint64_t seed, uint64_t i) { return double(random_bits(seed, i) >> 11) / 9007199254740992.; }

/// Points anywhere on triangles, by their area, each up to `noise` away along each axis.
PointCloud sampled(const TriangleSoup& soup, uint64_t count, double noise, bool normals) {
  std::vector<double> until;
  for (const auto& t : soup.triangles)
    until.push_back((until.empty() ? 0 : until.back()) +
                    triangle_area(soup.vertices[t[0]], soup.vertices[t[1]], soup.vertices[t[2]]));
  PointCloud cloud;
  for (uint64_t i = 0; i < count; ++i) {
    const auto at = std::lower_bound(until.begin(), until.end() - 1, unit(1, i) * until.back());
    const auto& t = soup.triangles[size_t(at - until.begin())];
    const WorldPoint &a = soup.vertices[t[0]], &b = soup.vertices[t[1]], &c = soup.vertices[t[2]];
    double u = unit(2, i), v = unit(3, i);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const WorldPoint off{2 * unit(4, i) - 1, 2 * unit(5, i) - 1, 2 * unit(6, i) - 1};
    cloud.position.push_back(a + u * (b - a) + v * (c - a) + noise * off);
    const WorldPoint n = doubled_area(a, b, c);
    if (normals) cloud.normal.push_back((1 / length(n)) * n);
  }
  return cloud;
}

double box_distance(const WorldPoint& p, const WorldPoint& half) {
  const WorldPoint q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
  const WorldPoint out{std::max(q.x, 0.), std::max(q.y, 0.), std::max(q.z, 0.)};
  return length(out) + std::min(0., std::max({q.x, q.y, q.z}));
}

double nearest_vertex(const TriangleSoup& soup, const WorldPoint& p) {
  double least = HUGE_VAL;
  for (const WorldPoint& v : soup.vertices) least = std::min(least, length(v - p));
  return least;
}

constexpr WorldPoint kHalf{1, .7, .5};
TriangleSoup box() { return shapes::box({-1, -.7, -.5}, {1, .7, .5}); }

/// Points of planes in a grid, .5 apart, outside of which `is_there` says nothing.
template <class Is>
void add_plane(std::vector<SidePoint>& points, const WorldPoint& normal, const WorldPoint& u, const WorldPoint& v,
               Is is_there) {
  for (int i = -12; i <= 12; ++i)
    for (int j = -12; j <= 12; ++j)
      if (const WorldPoint p = (.5 * i + .1) * u + (.5 * j + .2) * v; is_there(p)) points.push_back({p, normal, .25});
}

double distance_at(const std::vector<SidePoint>& points, const WorldPoint& place) {
  double nearest = HUGE_VAL;
  for (const SidePoint& p : points) nearest = std::min(nearest, length(p.at - place));
  return SidesOfPoints(.5).distance(place, points, nearest);
}

}  // namespace

TEST_CASE("sharp points: a box has its edges and corners, with normals or without, in any order and with any threads",
          "[points][unit]") {
  for (const bool normals : {true, false}) {
    PointCloud cloud = sampled(box(), 12000, 0, normals);
    PointSurfaceInfo info;
    const TriangleSoup soup = surface_of_points(cloud, 0, info, VolumeCreases::of_sharp_bodies);
    CHECK(info.sharp);
    CHECK(info.open_part == 0);
    CHECK(is_closed_2_manifold_by_edges(soup));
    for (const WorldPoint& p : soup.vertices) REQUIRE(std::abs(box_distance(p, kHalf)) < .3 * info.spacing_world);
    CHECK(volume(soup) == Approx(8 * .7 * .5).epsilon(2e-3));
    for (int c = 0; c < 8; ++c)
      CHECK(nearest_vertex(soup, {c & 4 ? 1. : -1., c & 2 ? .7 : -.7, c & 1 ? .5 : -.5}) < .5 * info.spacing_world);
    for (int i = -9; i <= 9; ++i) {
      const double at = .1 * i, along = info.voxel_size_world;  // vertices of an edge are about a voxel apart
      CHECK(nearest_vertex(soup, {at, .7, .5}) < along);
      CHECK(nearest_vertex(soup, {-1, .7 * at, .5}) < along);
    }
    std::reverse(cloud.position.begin(), cloud.position.end());
    std::reverse(cloud.normal.begin(), cloud.normal.end());
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    const TriangleSoup again = surface_of_points(cloud, 0, info, VolumeCreases::of_sharp_bodies);
    CHECK(again.triangles == soup.triangles);
    CHECK(std::memcmp(again.vertices.data(), soup.vertices.data(), soup.vertices.size() * sizeof(WorldPoint)) == 0);
  }
}

TEST_CASE("sharp points: a tenth of the spacing off the box they still give its sides", "[points][unit]") {
  PointSurfaceInfo info;
  const TriangleSoup soup = surface_of_points(sampled(box(), 20000, .002, false), 0, info, VolumeCreases::all);
  CHECK(info.sharp);
  CHECK(is_closed_2_manifold_by_edges(soup));
  int64_t near = 0;
  for (const WorldPoint& p : soup.vertices) near += std::abs(box_distance(p, kHalf)) < .3 * info.spacing_world;
  CHECK(near > int64_t(.99 * double(soup.vertices.size())));
}

TEST_CASE("sharp points: smooth and noisy bodies are as without creases", "[points][unit]") {
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 96), ring = shapes::torus(1, .3, 96, 48);
  for (const PointCloud& cloud : {sampled(ball, 8000, 0, false), sampled(ring, 8000, 0, true),
                                  sampled(ring, 8000, .01, false), sampled(box(), 8000, .02, false)}) {
    PointSurfaceInfo info;
    const TriangleSoup soup = surface_of_points(cloud, 0, info, VolumeCreases::of_sharp_bodies);
    CHECK_FALSE(info.sharp);
    const TriangleSoup without = surface_of_points(cloud, 0, info);
    CHECK(soup.triangles == without.triangles);
    CHECK(std::memcmp(soup.vertices.data(), without.vertices.data(), soup.vertices.size() * sizeof(WorldPoint)) == 0);
  }
}

TEST_CASE("sharp points: distances from sides are those from a convex, a hollow and a saddle's corner",
          "[points][unit]") {
  const WorldPoint x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  std::vector<SidePoint> convex, hollow, saddle;
  add_plane(convex, x, y, z, [](const WorldPoint& p) { return p.y < 0 && p.z < 0; });
  add_plane(convex, y, x, z, [](const WorldPoint& p) { return p.x < 0 && p.z < 0; });
  add_plane(convex, z, x, y, [](const WorldPoint& p) { return p.x < 0 && p.y < 0; });
  for (const SidePoint& p : convex) hollow.push_back({p.at, -1 * p.normal, p.area});
  // x < 0 and z < 0, or y < 0 and z < 0: the sides x and y meet in a hollow crease below their top z.
  add_plane(saddle, z, x, y, [](const WorldPoint& p) { return p.x < 0 || p.y < 0; });
  add_plane(saddle, x, y, z, [](const WorldPoint& p) { return p.y > 0 && p.z < 0; });
  add_plane(saddle, y, x, z, [](const WorldPoint& p) { return p.x > 0 && p.z < 0; });
  const auto of_corner = [](const WorldPoint& p) {
    const WorldPoint out{std::max(p.x, 0.), std::max(p.y, 0.), std::max(p.z, 0.)};
    return length(out) + std::min(0., std::max({p.x, p.y, p.z}));
  };
  for (uint64_t i = 0; i < 300; ++i) {
    const WorldPoint p{2 * unit(7, i) - 1, 2 * unit(8, i) - 1, 2 * unit(9, i) - 1};
    CHECK(distance_at(convex, p) == Approx(of_corner(p)).margin(1e-9));
    CHECK(distance_at(hollow, p) == Approx(-of_corner(p)).margin(1e-9));
    const bool is_inside = p.z < 0 && (p.x < 0 || p.y < 0);
    CHECK((distance_at(saddle, p) < 0) == is_inside);
  }
}
