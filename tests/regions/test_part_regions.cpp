// Meshes whose parts touch become one mesh of all regions.
#include <algorithm>
#include <cmath>
#include <cstddef>

#include "isoshell/io/mesh_file.h"
#include "isoshell/part_regions.h"
#include "isoshell/region_census.h"
#include "isoshell/remesh.h"
#include "regions/found_parts.h"
#include "regions/part_soups.h"
#include "regions/region_oracle.h"
#include "support/refusals.h"
#include "support/source_folder.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

int64_t faces_between(const FaceRegions& regions, int32_t a, int32_t b) {
  int64_t count = 0;
  for (const auto& [behind, front] : regions.labels) count += std::minmax(behind, front) == std::minmax(a, b);
  return count;
}

/// Sound regions on so many vertices, which is what was asked for.
TriangleMesh meshed(const TriangleSoup& soup, const std::string& parts, int64_t vertices) {
  TestContext context;
  RemeshOptions options;
  options.vertices = vertices;
  options.regions = parts;
  RemeshResult result = remesh(soup, options, context);
  for (const std::string& text : result.report.warnings) UNSCOPED_INFO(text);
  CHECK(int64_t(result.mesh.vertices.size()) == vertices);
  const RegionCensus census = take_region_census(result.mesh, context);
  CHECK(census.is_sound());
  CHECK(census.coincident_vertices == 0);
  return std::move(result.mesh);
}

double volume_of(const TriangleMesh& mesh, int32_t label) {
  return volumes_of_regions(mesh.vertices, mesh.triangles, mesh.regions)[label];
}

}  // namespace

TEST_CASE("parts: cubes that touch share their walls, whether or not their vertices are shared", "[regions][unit]") {
  const TriangleSoup apart = cubes_in_a_row(3);
  TriangleSoup welded = apart;
  for (auto& t : welded.triangles)
    for (uint32_t& v : t)
      for (uint32_t w = 0; w < v; ++w)
        if (apart.vertices[w].x == apart.vertices[v].x && apart.vertices[w].y == apart.vertices[v].y &&
            apart.vertices[w].z == apart.vertices[v].z) {
          v = w;
          break;
        }
  for (const TriangleSoup& soup : {apart, welded}) {
    const PartRegions found = regions_of(soup, "components");
    CHECK(found.warnings.empty());
    CHECK(fault_of_regions(found.walls.triangles, found.walls.regions).empty());
    CHECK(found.walls.triangles.size() == 3 * 12 - 4);
    CHECK(faces_between(found.walls.regions, 1, 2) == 2);
    CHECK(faces_between(found.walls.regions, 2, 3) == 2);
    for (int32_t label = 1; label <= 3; ++label) CHECK(volume_of(found.walls, label) == Approx(1));
  }
}

TEST_CASE("parts: cubes whose faces have vertices of their own are components", "[regions][unit]") {
  const TriangleSoup shared = cubes_in_a_row(2);
  for (const size_t faces : {1, 2}) {  // each triangle, each square
    const PartRegions found = regions_of(split_vertices(shared, faces), "components");
    CHECK(found.warnings.empty());
    CHECK(fault_of_regions(found.walls.triangles, found.walls.regions).empty());
    CHECK(pairs_of(found.walls.regions) == std::set<std::array<int32_t, 2>>{{0, 1}, {0, 2}, {1, 2}});
    CHECK(volume_of(found.walls, 1) == Approx(1));
    CHECK(volume_of(found.walls, 2) == Approx(1));
  }
}

TEST_CASE("parts: triangles without an area at an edge of two solids leave both apart", "[regions][unit]") {
  const TriangleSoup cubes = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 1, 0}, {2, 2, 1}));
  for (const std::array<uint32_t, 3> flat : {std::array<uint32_t, 3>{3, 7, 16}, {7, 3, 16}})
    for (const double z : {.5, 2.}) {  // the apex between the ends of the edge, and beyond them
      TriangleSoup soup;
      soup.vertices = cubes.vertices;
      soup.vertices.push_back({1, 1, z});
      soup.triangles.push_back(flat);
      for (auto t : cubes.triangles) {  // both have the vertices of their edge from the first
        for (uint32_t& v : t) v = v == 8 ? 3 : v == 12 ? 7 : v;
        soup.triangles.push_back(t);
      }
      const PartRegions found = regions_of(soup, "components");
      CHECK(pairs_of(found.walls.regions).size() == 2);
      CHECK(found.warnings.empty());
    }
}

TEST_CASE("parts: faces that bound no region are warned of", "[regions][unit]") {
  const TriangleSoup sheet = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  for (const std::string how : {"components", "cells"}) {
    const PartRegions found = regions_of(sheet, how);
    REQUIRE(found.warnings.size() == 1);
    CHECK(contains(found.warnings[0], "--regions " + how + " finds no region"));
  }
}

TEST_CASE("parts: walls that are there once are found as cells, whatever way they look", "[regions][unit]") {
  TriangleSoup soup = cubes_in_a_row(2);
  soup.triangles.erase(soup.triangles.begin() + 2, soup.triangles.begin() + 4);
  for (size_t t = 0; t < soup.triangles.size(); t += 3) std::swap(soup.triangles[t][0], soup.triangles[t][1]);
  const TriangleSoup walls = regions_of(soup, "cells").walls;
  CHECK(fault_of_regions(walls.triangles, walls.regions).empty());
  CHECK(pairs_of(walls.regions) == std::set<std::array<int32_t, 2>>{{0, 1}, {0, 2}, {1, 2}});
  CHECK(volume_of(walls, 1) == Approx(1));
}

TEST_CASE("parts: cells have the same numbers however faces are ordered", "[regions][unit]") {
  const TriangleSoup soup = cubes_in_a_row(4);
  const TriangleSoup one = regions_of(soup, "cells").walls, two = regions_of(shapes::shuffled(soup, 5), "cells").walls;
  CHECK(one.triangles == two.triangles);
  CHECK(one.regions.labels == two.regions.labels);
}

TEST_CASE("parts: a hollow is none of the region, and what lies in it is one of its own", "[regions][unit]") {
  const PartRegions hollow = regions_of(hollow_cube(), "components");
  CHECK(hollow.warnings.empty());
  CHECK(volume_of(hollow.walls, 1) == Approx(64 - 8));
  CHECK(pairs_of(hollow.walls.regions) == std::set<std::array<int32_t, 2>>{{0, 1}});
  const TriangleSoup filled = shapes::together(hollow_cube(), shapes::box({1.5, 1.5, 1.5}, {2.5, 2.5, 2.5}));
  const PartRegions both = regions_of(filled, "components");
  CHECK(volume_of(both.walls, 1) == Approx(64 - 8));
  CHECK(volume_of(both.walls, 2) == Approx(1));
  CHECK(faces_between(both.walls.regions, 0, 1) == 24);
  const TriangleSoup snug = shapes::together(hollow_cube(), shapes::box({1, 1, 1}, {3, 3, 3}));
  CHECK(faces_between(regions_of(snug, "components").walls.regions, 1, 2) == 12);
}

TEST_CASE("parts: a part that looks inward is turned where it lies in no other", "[regions][unit]") {
  const TriangleSoup soup =
      shapes::together(shapes::inside_out(shapes::box({0, 0, 0}, {1, 1, 1})), shapes::box({3, 0, 0}, {4, 1, 1}));
  const TriangleSoup walls = regions_of(soup, "components").walls;
  CHECK(fault_of_regions(walls.triangles, walls.regions).empty());
  CHECK(volume_of(walls, 1) == Approx(1));
  CHECK(volume_of(walls, 2) == Approx(1));
}

TEST_CASE("parts: faces that disagree about the outside close a part all the same", "[regions][unit]") {
  TriangleSoup soup = cubes_in_a_row(2);
  for (const size_t t : {0, 5, 13, 20, 21}) std::swap(soup.triangles[t][0], soup.triangles[t][1]);
  const PartRegions found = regions_of(soup, "components");
  CHECK(found.warnings.empty());
  CHECK(fault_of_regions(found.walls.triangles, found.walls.regions).empty());
  CHECK(volume_of(found.walls, 1) == Approx(1));
  CHECK(volume_of(found.walls, 2) == Approx(1));
}

TEST_CASE("parts: what is refused is named", "[regions][unit]") {
  TriangleSoup soup = cubes_in_a_row(2);
  CHECK(contains(message_of(ErrorCode::usage, [&] { regions_of(soup, "groups"); }), "no groups and no objects"));
  CpuContext context;
  context.memory_limit_bytes = 1000;
  CHECK(contains(message_of(ErrorCode::out_of_memory, [&] { find_part_regions(soup, {"components"}, context); }),
                 "raise --max-memory"));
  const TriangleSoup walls = regions_of(soup, "components").walls;
  CHECK(contains(message_of(ErrorCode::usage, [&] { regions_of(walls, "cells"); }), "parts regions already"));
}

TEST_CASE("parts: overlaps are measured where faces disagree about the outside", "[regions][unit]") {
  TriangleSoup big = shapes::box({0, 0, 0}, {4, 4, 4}), half_in = shapes::box({3, 1, 1}, {5, 2, 2});
  for (const size_t t : {0, 1, 4, 5, 9}) std::swap(half_in.triangles[t][0], half_in.triangles[t][1]);
  for (const size_t t : {2, 3, 8}) std::swap(big.triangles[t][0], big.triangles[t][1]);
  const PartRegions found = regions_of(shapes::together(big, half_in), "components");
  REQUIRE(found.warnings.size() == 1);
  CHECK(contains(found.warnings[0], "overlap in a volume of 1, 50 % of the second"));
  const TriangleSoup hollow = shapes::together(big, shapes::inside_out(shapes::box({1, 1, 1}, {3, 3, 3})));
  CHECK(volume_of(regions_of(hollow, "components").walls, 1) == Approx(64 - 8));
}

TEST_CASE("parts: sheets stay, in a solid and outside of all", "[regions][unit]") {
  const TriangleSoup cube = shapes::box({0, 0, 0}, {4, 4, 4});
  const TriangleSoup sheet = rectangle({1, 1, 2}, {2, 0, 0}, {0, 2, 0}),
                     free_one = rectangle({5, 0, 0}, {1, 0, 0}, {0, 1, 0});
  const PartRegions found = regions_of(shapes::together(shapes::together(cube, sheet), free_one), "components");
  CHECK(found.warnings.empty());
  CHECK(faces_between(found.walls.regions, 1, 1) == 2);
  CHECK(faces_between(found.walls.regions, 0, 0) == 2);
  CHECK(faces_between(found.walls.regions, 0, 1) == 12);
}

TEST_CASE("parts: a sheet all of whose faces are there from both sides stays", "[regions][unit]") {
  const TriangleSoup side = rectangle({1, 1, 2}, {2, 0, 0}, {0, 2, 0});
  TriangleSoup both = side;
  for (const auto& [a, b, c] : side.triangles) shapes::add_triangle(both, a, c, b);
  for (const TriangleSoup& sheet : {both, shapes::together(side, shapes::inside_out(side))}) {
    const PartRegions found = regions_of(shapes::together(shapes::box({0, 0, 0}, {4, 4, 4}), sheet), "components");
    CHECK(found.warnings.empty());
    CHECK(faces_between(found.walls.regions, 1, 1) == 2);
    CHECK(faces_between(found.walls.regions, 0, 1) == 12);
  }
}

TEST_CASE("parts: faces of a sheet are turned to look to one side", "[regions][unit]") {
  TriangleSoup sheet = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, 3, 3);
  for (const size_t t : {1, 4, 11}) std::swap(sheet.triangles[t][0], sheet.triangles[t][1]);
  const TriangleSoup walls = regions_of(sheet, "components").walls;
  std::set<std::array<uint32_t, 2>> passed;
  for (const auto& t : walls.triangles)
    for (size_t i = 0; i < 3; ++i) CHECK(passed.insert({t[i], t[(i + 1) % 3]}).second);
}

TEST_CASE("parts: a solid that lacks a face is named, and parts nothing", "[regions][unit]") {
  TriangleSoup soup = cubes_in_a_row(2);
  soup.triangles.erase(soup.triangles.begin());
  add_groups(soup, {{"left", 11}, {"right", 12}});
  const PartRegions found = regions_of(soup, "groups");
  REQUIRE(found.warnings.size() == 1);
  CHECK(contains(found.warnings[0], "part 1 (left) is not closed, 3 edges"));
  REQUIRE(found.walls.regions.names.size() == 1);
  CHECK(found.walls.regions.names[0].label == 1);
  CHECK(found.walls.regions.names[0].name == "right");
}

TEST_CASE("parts: groups are parts, with their names, of several components each", "[regions][unit]") {
  TriangleSoup soup = cubes_in_a_row(4);
  add_groups(soup, {{"steel", 24}, {"rubber", 24}});
  const PartRegions found = regions_of(soup, "groups");
  CHECK(volume_of(found.walls, 1) == Approx(2));
  CHECK(volume_of(found.walls, 2) == Approx(2));
  CHECK(found.walls.triangles.size() == 36 + 2);
  REQUIRE(found.walls.regions.names.size() == 2);
  CHECK(found.walls.regions.names[1].name == "rubber");
  CHECK(contains(message_of(ErrorCode::usage, [&] { regions_of(soup, "material"); }), "what they have is group"));
}

TEST_CASE("parts: faces that are there twice are walls once", "[regions][unit]") {
  const TriangleSoup twice = shapes::together(cubes_in_a_row(2), cubes_in_a_row(2));
  TriangleSoup grouped = twice;
  add_groups(grouped, {{"a", 12}, {"b", 12}, {"a", 12}, {"b", 12}});
  grouped.attributes[0].values = {};
  for (int f = 0; f < 48; ++f) grouped.attributes[0].values.push_back(f / 12 % 2);
  const PartRegions found = regions_of(grouped, "groups");
  CHECK(found.warnings.empty());
  CHECK(found.walls.triangles.size() == 22);
  CHECK(volume_of(found.walls, 2) == Approx(1));
}

TEST_CASE("part meshes: two cubes keep their planes, edges and volumes") {
  const TriangleMesh mesh = meshed(cubes_in_a_row(2), "components", 600);
  CHECK(std::abs(volume_of(mesh, 1) - 1) < 1e-6);
  CHECK(std::abs(volume_of(mesh, 2) - 1) < 1e-6);
  CHECK(pairs_of(mesh.regions) == std::set<std::array<int32_t, 2>>{{0, 1}, {0, 2}, {1, 2}});
}

TEST_CASE("part meshes: vertices of flat walls are on their planes, and corners where they were, to the last bit") {
  const TriangleMesh cubes = meshed(cubes_in_a_row(2), "components", 4000);
  for (const WorldPoint& p : cubes.vertices) {
    const double off = std::min({std::abs(p.x), std::abs(p.x - 1), std::abs(p.x - 2), std::abs(p.y), std::abs(p.y - 1),
                                 std::abs(p.z), std::abs(p.z - 1)});
    REQUIRE(off == 0);
  }
  const WorldPoint corner{.123456789, .2, .5};
  const TriangleSoup sheet =
      shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), rectangle(corner, {.6, 0, 0}, {0, .6, 0}));
  const TriangleMesh mesh = meshed(sheet, "components", 1000);
  CHECK(std::count_if(mesh.vertices.begin(), mesh.vertices.end(),
                      [&](const WorldPoint& p) { return p.x == corner.x && p.y == corner.y && p.z == corner.z; }) == 1);
}

TEST_CASE("part meshes: a pin in a hole shares the wall of the hole") {
  const TriangleSoup soup = pin_in_a_plate();
  const PartRegions found = regions_of(soup, "components");
  CHECK(found.warnings.empty());
  CHECK(faces_between(found.walls.regions, 1, 2) == 64);
  const TriangleMesh mesh = meshed(soup, "components", 1500);
  for (const int32_t label : {1, 2})
    CHECK(volume_of(mesh, label) == Approx(volume_of(found.walls, label)).epsilon(.01));
}

TEST_CASE("part meshes: a cube in a hollow one, and a sheet in a cube") {
  const TriangleSoup filled = shapes::together(hollow_cube(), shapes::box({1.5, 1.5, 1.5}, {2.5, 2.5, 2.5}));
  const TriangleMesh cubes = meshed(filled, "components", 2000);
  CHECK(std::abs(volume_of(cubes, 1) - 56) < 64e-6);
  CHECK(std::abs(volume_of(cubes, 2) - 1) < 64e-6);
  const TriangleSoup cut =
      shapes::together(shapes::box({0, 0, 0}, {4, 4, 4}), rectangle({1, 1, 2}, {2, 0, 0}, {0, 2, 0}));
  const TriangleMesh sheet = meshed(cut, "components", 1000);
  CHECK(faces_between(sheet.regions, 1, 1) > 20);
  TestContext context;
  CHECK(region_of(sheet, 1).triangles.size() + size_t(faces_between(sheet.regions, 1, 1)) == sheet.triangles.size());
}

TEST_CASE("part meshes: a cylinder through a plate is cut where they meet") {
  const TriangleSoup soup = shapes::together(shapes::box({-3, -3, -.5}, {3, 3, .5}), cylinder(-2, 2));
  const PartRegions found = regions_of(soup, "components");
  REQUIRE(found.warnings.size() == 1);
  CHECK(contains(found.warnings[0], "25 % of the second"));
  const TriangleMesh mesh = meshed(soup, "components", 2000);
  CHECK(volume_of(mesh, 1) == Approx(36).epsilon(1e-6));
  const double pin = 32 / 2 * std::sin(6.283185307179586 / 32) * 3;
  CHECK(volume_of(mesh, 2) == Approx(pin).epsilon(.01));
  for (const double x : {-3, 3})
    for (const double z : {-.5, .5})
      CHECK(std::any_of(mesh.vertices.begin(), mesh.vertices.end(), [&](const WorldPoint& p) {
        return std::abs(p.x - x) < 1e-6 && std::abs(p.y - 3) < 1e-6 && std::abs(p.z - z) < 1e-6;
      }));
}

TEST_CASE("part meshes: cubes of different sizes, that touch within a face") {
  const TriangleSoup soup =
      shapes::together(shapes::box({0, 0, 0}, {2, 2, 2}), shapes::box({2, .5, .5}, {3, 1.5, 1.5}));
  const TriangleMesh mesh = meshed(soup, "components", 1000);
  CHECK(std::abs(volume_of(mesh, 1) - 8) < 1e-6);
  CHECK(std::abs(volume_of(mesh, 2) - 1) < 1e-6);
  CHECK(faces_between(mesh.regions, 1, 2) > 20);
}

TEST_CASE("part meshes: a sheet across a cube makes two cells of it") {
  const TriangleSoup soup =
      shapes::together(shapes::box({0, 0, 0}, {4, 4, 4}), rectangle({0, 0, 1}, {4, 0, 0}, {0, 4, 0}));
  const TriangleMesh mesh = meshed(soup, "cells", 1000);
  CHECK(std::abs(volume_of(mesh, 1) - 16) < 1e-5);
  CHECK(std::abs(volume_of(mesh, 2) - 48) < 1e-5);
}

TEST_CASE("part meshes: a region that touches itself along an edge is sound") {
  TriangleSoup soup = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 1, 0}, {2, 2, 1}));
  add_groups(soup, {{"both", 24}});
  const TriangleMesh mesh = meshed(soup, "groups", 600);
  CHECK(std::abs(volume_of(mesh, 1) - 2) < 1e-6);
}

TEST_CASE("part meshes: the same with any number of threads") {
  const TriangleSoup soup = shapes::together(shapes::box({-3, -3, -.5}, {3, 3, .5}), cylinder(-2, 2));
  CpuContext one, two;
  one.threads = 1;
  two.threads = 2;
  RemeshOptions options;
  options.vertices = 800;
  options.regions = "components";
  const TriangleMesh a = remesh(soup, options, one).mesh, b = remesh(soup, options, two).mesh;
  CHECK(a.triangles == b.triangles);
  CHECK(a.regions.labels == b.regions.labels);
  CHECK(std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(),
                   [](const WorldPoint& p, const WorldPoint& q) { return p.x == q.x && p.y == q.y && p.z == q.z; }));
}

TEST_CASE("part meshes: three sheets that meet in a line share it") {
  TriangleSoup soup = rectangle({0, 0, 0}, {1, 0, 0}, {0, 1, 0});
  soup = shapes::together(soup, rectangle({0, 0, 0}, {-1, 0, 0}, {0, 1, 0}));
  soup = shapes::together(soup, rectangle({0, 0, 0}, {0, 0, 1}, {0, 1, 0}));
  const TriangleMesh mesh = meshed(soup, "components", 500);
  CpuContext context;
  const RegionCensus census = take_region_census(mesh, context);
  CHECK(census.regions.empty());
  CHECK(census.curve_edges > 5);
}

TEST_CASE("part meshes: sheets that touch at a point, where a curve of one of them ends") {
  TestContext context;
  RemeshOptions options;
  options.vertices = 300;
  options.regions = "components";
  const RemeshResult result =
      remesh(read_mesh(source_folder() + "/tests/data/sheets_at_a_point.stl"), options, context);
  CHECK(result.mesh.vertices.size() >= 300);
  CHECK(take_region_census(result.mesh, context).coincident_vertices == 0);
}
