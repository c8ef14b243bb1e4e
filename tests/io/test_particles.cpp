// Points that fill a volume, as particles of a fluid, are told from those of surfaces.
#include <cmath>
#include <string>

#include "implicit/points/unflat_points.h"
#include "isoshell/io/input.h"
#include "isoshell/io/mesh_file.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/source_folder.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

using Points = std::vector<WorldPoint>;

double random(uint64_t axis, uint64_t i) { return double(random_bits(axis, i) >> 11) / double(uint64_t(1) << 53); }

/// Particles one apart in a box, each moved by up to `jitter` along each axis.
Points grid(int nx, int ny, int nz, double jitter) {
  Points points;
  for (int i = 0; i < nx * ny * nz; ++i) {
    const auto moved = [&](int at, uint64_t axis) { return at + jitter * (2 * random(axis, uint64_t(i)) - 1); };
    points.push_back({moved(i % nx, 0), moved(i / nx % ny, 1), moved(i / nx / ny, 2)});
  }
  return points;
}

Points random_box(int count, double height) {
  Points points;
  for (uint64_t i = 0; i < uint64_t(count); ++i) points.push_back({random(0, i), random(1, i), height * random(2, i)});
  return points;
}

Points random_ball(int count) {
  Points points;
  for (const WorldPoint& p : random_box(count, 1)) {
    const WorldPoint q = 2 * p - WorldPoint{1, 1, 1};
    if (dot(q, q) < 1) points.push_back(q);
  }
  return points;
}

/// Of a sphere along a spiral, each moved by up to `noise` spacings along each axis.
Points sphere(int count, double noise) {
  Points points;
  const double spacing = std::sqrt(4 * std::acos(-1) / count);
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z), turn = 2.399963229728653 * i;
    const auto shift = [&](uint64_t axis) { return noise * spacing * (2 * random(axis, uint64_t(i)) - 1); };
    points.push_back({r * std::cos(turn) + shift(0), r * std::sin(turn) + shift(1), z + shift(2)});
  }
  return points;
}

/// The two sides of a plate, points one apart.
Points plate(double thick) {
  Points points;
  for (const WorldPoint& p : grid(40, 40, 1, 0)) points.push_back(p), points.push_back({p.x, p.y, thick});
  return points;
}

Points wire(double thick) {
  Points points;
  for (uint64_t i = 0; i < 2000; ++i)
    points.push_back({.1 * double(i), thick * random(0, i), thick * random(1, i) + 20 * std::sin(.003 * double(i))});
  return points;
}

double part_of(const Points& points) { return unflat_part(points, PointTree(points)); }

}  // namespace

TEST_CASE("particles: most points of a volume have no flat neighbourhood, on a grid, at random, few or many",
          "[points][unit]") {
  for (const double jitter : {0., .05, .3}) {
    INFO("jitter " << jitter);
    CHECK(part_of(grid(5, 5, 5, jitter)) > .9);
    CHECK(part_of(grid(20, 20, 20, jitter)) > .9);
    CHECK(part_of(grid(60, 60, 4, jitter)) > .9);
  }
  for (const int count : {200, 1000, 20000}) {
    INFO(count << " at random");
    CHECK(part_of(random_ball(count)) > .75);
    CHECK(part_of(random_box(count, 1)) > .75);
    CHECK(part_of(random_box(count, .4)) > .75);
  }
}

TEST_CASE("particles: few points of a surface have none, noisy, thin, narrow or coarse as it may be",
          "[points][unit]") {
  for (const int count : {100, 300, 5000, 30000}) {
    INFO(count << " points");
    CHECK(part_of(sphere(count, 0)) == 0);
    CHECK(part_of(sphere(count, .5)) < .25);
  }
  CHECK(part_of(sphere(5000, 1)) == 0);
  CHECK(part_of(sphere(5000, 2)) < .05);
  for (const double thick : {1., 2., 3., 5.}) CHECK(part_of(plate(thick)) < .05);
  for (const double thick : {.05, .5, 2.}) CHECK(part_of(wire(thick)) == 0);
  CHECK(part_of(read_mesh(source_folder() + "/tests/data/nefertiti.ply").vertices) < .01);
}

TEST_CASE("particles: too few points tell nothing", "[points][unit]") { CHECK(part_of(grid(4, 4, 3, .1)) == 0); }

TEST_CASE("particles: a warning says that points fill a volume, and none of those of a surface", "[points][unit]") {
  PointCloud cloud;
  cloud.position = grid(9, 9, 9, .2);
  const auto warnings = [&] {
    std::string all;
    input_of(cloud, "fluid", 0, [&](MessageKind kind, const std::string& text) {
      if (kind == MessageKind::warning) all += text + "\n";
    });
    return all;
  };
  CHECK(contains(warnings(), "the points fill a volume, as particles of a fluid do: "));
  CHECK(
      contains(warnings(), " % of them have no flat neighbourhood; a surface around particles is made by a tool such"));
  cloud.position = sphere(2000, .3);
  CHECK_FALSE(contains(warnings(), "fluid do"));
}
