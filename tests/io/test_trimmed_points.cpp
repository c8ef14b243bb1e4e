// Clouds of open surfaces, which have borders where borders are kept.
#include <cmath>

#include "geometry/world_vector.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "isoshell/io/point_file.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

double random(uint64_t axis, uint64_t i) { return double(random_bits(axis, i) >> 11) / double(uint64_t(1) << 53); }

/// Points of a square of side 1, bent, each moved by up to `noise`.
PointCloud sheet(int count, double bend, double noise) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double x = random(0, uint64_t(i)), y = random(1, uint64_t(i));
    cloud.position.push_back(
        {x, y, bend * std::sin(4 * x) * std::cos(3 * y) + noise * (2 * random(2, uint64_t(i)) - 1)});
  }
  return cloud;
}

InputTopology topology_of(const TriangleSoup& soup) {
  Context context;
  return measure_topology(soup, context).topology;
}

double area_of(const TriangleSoup& soup) { return topology_of(soup).area_world; }

TriangleSoup surface(const PointCloud& cloud, bool keep_open) {
  PointSurfaceInfo info;
  return surface_of_points(cloud, 0, info, VolumeCreases::none, keep_open);
}

}  // namespace

TEST_CASE("trimmed points: a sheet has one border and the area of its points, noisy or not", "[points][unit]") {
  for (const double noise : {0., .002, .005})
    for (const double bend : {0., .1}) {
      INFO("noise " << noise << ", bend " << bend);
      const PointCloud cloud = sheet(6000, bend, noise);
      const TriangleSoup closed = surface(cloud, false), open = surface(cloud, true);
      CHECK(topology_of(closed).closed);
      const InputTopology topology = topology_of(open);
      CHECK(topology.components == 1);
      CHECK(topology.boundary_loops == 1);
      const double truth = bend == 0 ? 1 : 1.02;
      CHECK(area_of(open) > truth);
      CHECK(area_of(open) < 1.12 * truth);
      CHECK(area_of(closed) > 2 * truth);
      double up = 0;  // the sheet seen from above
      for (const auto& [a, b, c] : open.triangles)
        up += doubled_area(open.vertices[a], open.vertices[b], open.vertices[c]).z / 2;
      CHECK(up > .9);
    }
}

TEST_CASE("trimmed points: a ball that is whole stays closed, and one with a hole has a border there",
          "[points][unit]") {
  PointCloud whole, cut;
  for (int i = 0; i < 5000; ++i) {
    const double z = 2 * random(0, uint64_t(i)) - 1, turn = 2 * std::acos(-1) * random(1, uint64_t(i)),
                 r = std::sqrt(1 - z * z);
    whole.position.push_back({r * std::cos(turn), r * std::sin(turn), z});
    if (z < .6) cut.position.push_back(whole.position.back());
  }
  CHECK(topology_of(surface(whole, true)).closed);
  const TriangleSoup open = surface(cut, true);
  CHECK(!topology_of(open).closed);
  for (const WorldPoint& p : open.vertices) CHECK(p.z < .75);
}

TEST_CASE("trimmed points: of many bodies each stays, however small", "[points][unit]") {
  PointCloud cloud;
  for (int body = 0; body < 27; ++body)
    for (int i = 0; i < 200; ++i) {
      const double z = 1 - (2 * i + 1.) / 200, r = std::sqrt(1 - z * z), turn = 2.399963229728653 * i;
      const WorldPoint n{r * std::cos(turn), r * std::sin(turn), z};
      const double size = body == 0 ? 3 : 1;
      cloud.normal.push_back(n);
      cloud.position.push_back(
          {8. * (body % 3) + size * n.x, 8. * (body / 3 % 3) + size * n.y, 8. * (body / 9) + size * n.z});
    }
  const int64_t whole = topology_of(surface(cloud, false)).components;
  CHECK(whole == 27);
  CHECK(topology_of(surface(cloud, true)).components == whole);
}

TEST_CASE("trimmed points: where no point has others around it, nothing is left, and an error says why",
          "[points][unit]") {
  PointCloud few;
  for (int i = 0; i < 5; ++i)
    few.position.push_back({random(0, uint64_t(i)), random(1, uint64_t(i)), random(2, uint64_t(i))});
  CHECK(topology_of(surface(few, false)).closed);
  CHECK(contains(message_of(ErrorCode::nothing_to_mesh, [&] { surface(few, true); }), "leave that out"));
}

TEST_CASE("points of flat ground with trees over it become the ground, though a body of flat sides is none of it",
          "[points][unit]") {
  for (const int trees : {3, 12, 20}) {
    INFO(trees << " trees");
    PointCloud cloud = sheet(3000, 0, 0);
    for (int i = 0; i < trees * 60; ++i) {
      const auto at = [&](uint64_t axis) { return random(axis, uint64_t(i)) - .5; };
      const uint64_t tree = uint64_t(i % trees);
      cloud.position.push_back({random(7, tree) + .06 * at(4), random(8, tree) + .06 * at(5), .08 + .06 * at(6)});
    }
    PointSurfaceInfo info;
    const TriangleSoup surface = surface_of_points(cloud, 0, info, VolumeCreases::all);
    CHECK(area_of(surface) > 1);
    CHECK(info.held_part > .8);
  }
}

TEST_CASE("points of a body that is a few of their spacings thick are on both of its sides, and no scan of one",
          "[points][unit]") {
  for (const int thick : {5, 8, 10, 12}) {
    INFO(thick << " spacings");
    PointCloud cloud;
    const auto add = [&](double x, double y, double z) { cloud.position.push_back({x, y, z}); };
    for (int i = 0; i < 30; ++i) {
      for (int j = 0; j < 20; ++j) add(i + .5, j + .5, 0), add(i + .5, j + .5, thick);
      for (int k = 0; k < thick; ++k) add(i + .5, 0, k + .5), add(i + .5, 20, k + .5);
    }
    for (int j = 0; j < 20; ++j)
      for (int k = 0; k < thick; ++k) add(0, j + .5, k + .5), add(30, j + .5, k + .5);
    for (const VolumeCreases creases : {VolumeCreases::none, VolumeCreases::all}) {
      PointSurfaceInfo info;
      const double area = area_of(surface_of_points(cloud, 0, info, creases)), truth = 1200 + 100 * thick;
      CHECK(area > .9 * truth);
      CHECK(area < 1.03 * truth);
      CHECK(info.open_part < .02);
    }
  }
}
