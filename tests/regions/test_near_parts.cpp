// Parts of meshes that lie in others, nearly on others, or leave thin spaces between them.
#include <cmath>

#include "geometry/world_vector.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/boolean_union.h"
#include "isoshell/part_regions.h"
#include "isoshell/quality.h"
#include "isoshell/region_census.h"
#include "isoshell/remesh.h"
#include "regions/found_parts.h"
#include "regions/part_soups.h"
#include "regions/region_oracle.h"
#include "support/refusals.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

TriangleSoup together_as_groups(const std::vector<TriangleSoup>& parts) {
  TriangleSoup all;
  std::vector<std::pair<std::string, size_t>> groups;
  for (const TriangleSoup& part : parts) {
    all = shapes::together(std::move(all), part);
    groups.push_back({"part " + std::to_string(groups.size()), part.triangles.size()});
  }
  add_groups(all, groups);
  return all;
}

}  // namespace

TEST_CASE("parts: one that lies in another keeps its space, whichever comes first", "[regions][unit]") {
  const TriangleSoup big = shapes::box({0, 0, 0}, {4, 4, 4}), small = shapes::box({1, 1, 1}, {2, 2, 2}),
                     smallest = shapes::box({1.25, 1.25, 1.25}, {1.5, 1.5, 1.5});
  for (const char* parts : {"components", "groups"}) {
    const PartRegions first = regions_of(together_as_groups({small, big}), parts);
    CHECK(volume_of(first.walls, 1) == Approx(1));
    CHECK(volume_of(first.walls, 2) == Approx(63));
    CHECK(first.warnings.empty());
    const PartRegions last = regions_of(together_as_groups({big, smallest, small}), parts);
    CHECK(volume_of(last.walls, 1) == Approx(63));
    CHECK(volume_of(last.walls, 2) == Approx(1. / 64));
    CHECK(volume_of(last.walls, 3) == Approx(1 - 1. / 64));
    CHECK(last.warnings.empty());
  }
}

TEST_CASE("parts: of two with the same space the first keeps it, and a warning says so", "[regions][unit]") {
  const TriangleSoup cube = shapes::box({0, 0, 0}, {4, 4, 4});
  const PartRegions found = regions_of(shapes::together(cube, cube), "components");
  CHECK(volume_of(found.walls, 1) == Approx(64));
  REQUIRE(found.warnings.size() == 1);
  CHECK(contains(found.warnings[0], "part 1 and part 2 overlap in a volume of 64, 100 % of the second"));
}

TEST_CASE("parts: two copies of one part overlap, though one is a little smaller", "[regions][unit]") {
  const TriangleSoup cube = shapes::box({0, 0, 0}, {4, 4, 4}), smaller = shapes::box({0, 0, 0}, {4, 4, 3.998});
  const PartRegions found = regions_of(shapes::together(cube, smaller), "components");
  CHECK(volume_of(found.walls, 1) == Approx(64));
  REQUIRE(found.warnings.size() == 1);
  CHECK(contains(found.warnings[0], "100 % of the second; part 1 keeps it"));
}

TEST_CASE("parts: what is nearer than is asked for is one wall", "[regions][unit]") {
  const TriangleSoup low = shapes::box({0, 0, 0}, {4, 4, 1}), high = shapes::box({1, 1, 1.01}, {3, 3, 2});
  const auto pairs_when = [&](double near_world) {
    TestContext context;
    return pairs_of(find_part_regions(shapes::together(low, high), {"components", near_world}, context).walls.regions);
  };
  CHECK(pairs_when(.009) == std::set<std::array<int32_t, 2>>{{0, 1}, {0, 2}});
  CHECK(pairs_when(.011) == std::set<std::array<int32_t, 2>>{{0, 1}, {0, 2}, {1, 2}});
}

TEST_CASE("unions: what is nearer than is asked for is joined", "[regions][unit]") {
  const TriangleSoup boxes = shapes::together(shapes::box({0, 0, 0}, {4, 4, 1}), shapes::box({1, 1, 1.01}, {3, 3, 2}));
  for (const double near_world : {.009, .011}) {
    UnionOptions options;
    options.near_world = near_world;
    UnionReport report;
    TestContext context;
    const UnitedSoup united = boolean_union(boxes, options, report, context);
    CHECK(report.given_up.empty());
    CHECK(measure_topology(united.soup, context).topology.components == (near_world < .01 ? 2 : 1));
  }
}

TEST_CASE("parts: a thin space between parts belongs to what is beside", "[regions][unit]") {
  // A box in the hollow of another one, with a gap of .01 on all sides.
  const TriangleSoup around = shapes::box({0, 0, 0}, {4, 4, 4}),
                     hollow = shapes::inside_out(shapes::box({1, 1, 1}, {3, 3, 3})),
                     inner = shapes::box({1.01, 1.01, 1.01}, {2.99, 2.99, 2.99});
  const TriangleSoup all = shapes::together(shapes::together(around, hollow), inner);
  const auto found_when = [&](double thin_world) {
    TestContext context;
    return find_part_regions(all, {"components", 0, thin_world}, context);
  };
  const PartRegions apart = found_when(.009), joined = found_when(.011);
  CHECK(apart.warnings.empty());
  CHECK(volume_of(apart.walls, 1) == Approx(64 - 8));
  CHECK(volume_of(joined.walls, 1) == Approx(64 - std::pow(1.98, 3)));
  REQUIRE(joined.warnings.size() == 1);
  CHECK(contains(joined.warnings[0], "1 space between faces, the first near 1 1 1, is less than 0.011 thick"));
  TestContext context;
  const PartRegions cells = find_part_regions(all, {"cells", 0, .011}, context);
  CHECK(pairs_of(cells.walls.regions) == std::set<std::array<int32_t, 2>>{{0, 1}, {1, 2}});
}

TEST_CASE("parts: plates with any gap between them keep their count, and share a wall or none", "[regions][unit]") {
  for (const double gap : {0., 1e-9, 5e-6, 2e-5, 1e-4, 3e-4, 1e-3, 3e-3}) {
    TriangleSoup plates =
        shapes::together(shapes::box({0, 0, 0}, {4, 3, .5}), shapes::box({.5, .5, .5 + gap}, {3, 2, 1}));
    for (WorldPoint& p : plates.vertices) p = {.8 * p.x - .6 * p.z, p.y, .6 * p.x + .8 * p.z};
    RemeshOptions options;
    options.vertices = 1000;
    options.regions = "components";
    TestContext context;
    const RemeshResult result = remesh(plates, options, context);
    INFO("a gap of " << gap);
    CHECK(result.mesh.vertices.size() == 1000);
    const RegionCensus census = take_region_census(result.mesh, context);
    CHECK(census.is_sound());
    CHECK(result.report.optimize.self_intersections == 0);
    CHECK(volumes_of_regions(result.mesh.vertices, result.mesh.triangles, result.mesh.regions)[2] ==
          Approx(2.5 * 1.5 * (.5 - gap)).epsilon(2e-3));
  }
}

TEST_CASE("parts: a pin with other facets than its hole shares the wall when it is snapped", "[regions][unit]") {
  const TriangleSoup loose = together_as_groups({plate_with_hole(36), cylinder(0, 1, 48)});  // .004 apart
  RemeshOptions options;
  options.vertices = 1500;
  options.regions = "groups";
  options.snap_world = .006;
  TestContext context;
  const RemeshResult result = remesh(loose, options, context);
  CHECK(take_region_census(result.mesh, context).is_sound());
  CHECK(result.mesh.vertices.size() == 1500);
  CHECK(pairs_of(result.mesh.regions) == std::set<std::array<int32_t, 2>>{{0, 1}, {0, 2}, {1, 2}});
  CHECK(measure_quality(result.mesh).theta_min_deg >= 30);
  options.snap_world = .5;
  CHECK(contains(message_of(ErrorCode::usage, [&] { remesh(loose, options, context); }),
                 "--snap is 0.5; it may be at most a 20th of the longest side, 0.298858"));
}

TEST_CASE("parts: a pin a little smaller than its hole shares all of the wall, or none", "[regions][unit]") {
  for (const double near : {.006, .009, .012, .1 / 3}) {
    for (const double gap : {.005, .01, .015, .017}) {
      TriangleSoup pin = cylinder(0, 1, 48);
      for (WorldPoint& p : pin.vertices) p = {(1 - gap) * p.x, (1 - gap) * p.y, p.z};
      const TriangleSoup loose = together_as_groups({plate_with_hole(48), pin});
      CpuContext context;
      const TriangleSoup walls = find_part_regions(loose, {"groups", near}, context).walls;
      double shared = 0;
      for (size_t t = 0; t < walls.triangles.size(); ++t) {
        const auto& [a, b, c] = walls.triangles[t];
        if (walls.regions.labels[t] == std::array<int32_t, 2>{1, 2})
          shared += triangle_area(walls.vertices[a], walls.vertices[b], walls.vertices[c]);
      }
      INFO("a gap of " << gap << ", near is " << near);
      CHECK(shared == Approx(gap < 2 * near ? 96 * std::sin(std::acos(-1) / 48) : 0).epsilon(.05));
    }
  }
}

TEST_CASE("parts: nothing is said of near parts that are made one as they should be", "[regions][unit]") {
  const TriangleSoup boxes = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1.001, 0, 0}, {2, 1, 1}));
  CpuContext context;
  for (const double near : {.0065, .0031, .0047, .0013, .0119})
    CHECK(find_part_regions(boxes, {"cells", near, near}, context).warnings.empty());
}

TEST_CASE("parts: where cuts do not end with what is near made one, only what meets is, and a warning says so",
          "[regions][unit]") {
  constexpr int kBars = 11;
  TriangleSoup bars;  // each turned by a share of 180 degrees, and tilted by .003 rad, more than the one before
  for (int i = 0; i < kBars; ++i) {
    const double turn = M_PI * i / kBars, tilt = .003 * i;
    TriangleSoup bar = shapes::box({-1, -.1, -.1}, {1, .1, .1});
    for (WorldPoint& p : bar.vertices) {
      const double y = p.y * std::cos(tilt) - p.z * std::sin(tilt), z = p.y * std::sin(tilt) + p.z * std::cos(tilt);
      p = {p.x * std::cos(turn) - y * std::sin(turn), p.x * std::sin(turn) + y * std::cos(turn), z};
    }
    bars = shapes::together(std::move(bars), bar);
  }
  CpuContext context;
  const PartRegions found = find_part_regions(bars, {"cells", .03, .03}, context);
  REQUIRE(!found.warnings.empty());
  CHECK(contains(found.warnings[0], "only what meets was made one, and not what is nearer than 0.03"));
  CHECK(contains(found.warnings[0], "give another --snap"));
}

TEST_CASE("parts: those that nearly touch are named with their gap, and those that share a wall or stay apart are not",
          "[regions][unit]") {
  CpuContext context;
  const TriangleSoup plate = shapes::box({0, 0, 0}, {4, 4, 1});
  const auto warnings_of = [&](const TriangleSoup& pin) {
    return find_part_regions(together_as_groups({plate, pin}), {"groups", 0, 0, .125}, context).warnings;
  };
  const std::vector<std::string> near = warnings_of(shapes::box({1, 1, 1.0625}, {2, 2, 2}));
  REQUIRE(near.size() == 1);
  CHECK(contains(near[0], "regions 1 (part 0) and 2 (part 1) are 0.0625 apart near "));
  CHECK(contains(near[0], "--snap"));
  CHECK(warnings_of(shapes::box({1, 1, 1.25}, {2, 2, 2})).empty());
  CHECK(warnings_of(shapes::box({1, 1, 1}, {2, 2, 2})).empty());
}

TEST_CASE("parts: crossed bars are near where only their edges are, and parts of a thin layer between them are not",
          "[regions][unit]") {
  CpuContext context;
  const auto warnings_of = [&](const std::vector<TriangleSoup>& parts) {
    return find_part_regions(together_as_groups(parts), {"groups", 0, 0, .125}, context).warnings;
  };
  const TriangleSoup bar = shapes::box({-8, 0, 0}, {8, .5, .5}), across = shapes::box({0, -8, .5625}, {.5, 8, 1});
  const std::vector<std::string> near = warnings_of({bar, across});
  REQUIRE(near.size() == 1);
  CHECK(contains(near[0], "are 0.0625 apart"));
  CHECK(warnings_of({shapes::box({0, 0, 0}, {4, 4, 1}), shapes::box({0, 0, 1}, {4, 4, 1.0625}),
                     shapes::box({0, 0, 1.0625}, {4, 4, 2})})
            .empty());
}
