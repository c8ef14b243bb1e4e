// Regions counted and measured, and taken out of their complex, against cubes that are counted by hand.
#include <algorithm>
#include <cmath>
#include <cstring>

#include "isoshell/mesh_topology.h"
#include "isoshell/region_census.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "unit/region_cubes.h"

using namespace isoshell;

namespace {

RegionCensus census_of(const TriangleMesh& mesh) {
  Context context;
  return take_region_census(mesh, context);
}

/// In opposite corners of a cube of eight.
TriangleMesh cubes_that_touch_in_a_vertex() { return mesh_of(LabelledCubes{{2, 2, 2}, {1, 0, 0, 0, 0, 0, 0, 1}}); }

TriangleMesh cube_in_a_hollow() {
  LabelledCubes cubes{{3, 3, 3}, std::vector<int32_t>(27, 1)};
  cubes.labels[13] = 2;
  return mesh_of(cubes);
}

Attribute attribute(const char* name, AttributeDomain domain, int32_t components, size_t count) {
  Attribute a;
  a.name = name;
  a.domain = domain;
  a.components = components;
  for (size_t i = 0; i < count * size_t(components); ++i) a.values.push_back(double(i));
  return a;
}

WorldPoint normal_of(const TriangleMesh& mesh, size_t triangle) {
  const auto& [a, b, c] = mesh.triangles[triangle];
  const WorldPoint &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
  const WorldPoint u{q.x - p.x, q.y - p.y, q.z - p.z}, v{r.x - p.x, r.y - p.y, r.z - p.z};
  return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

}  // namespace

TEST_CASE("region census: two boxes that share a wall are two closed regions and three walls", "[regions][unit]") {
  TriangleMesh mesh = two_cubes();
  mesh.regions.names = {{2, "bone"}};
  const RegionCensus census = census_of(mesh);
  REQUIRE(census.regions.size() == 2);
  for (const RegionCounts& region : census.regions) {
    CHECK(region.closed);
    CHECK(region.faces == 12);
    CHECK(region.vertices == 8);
    CHECK(region.components == 1);
    CHECK(region.genus == 0);
    CHECK(region.open_edges == 0);
    CHECK(region.touching_vertices == 0);
    CHECK(region.volume_world == Approx(1));
    CHECK(region.area_world == Approx(6));
  }
  CHECK(census.regions[0].label == 1);
  CHECK(census.regions[0].name.empty());
  CHECK(census.regions[1].label == 2);
  CHECK(census.regions[1].name == "bone");
  REQUIRE(census.walls.size() == 3);
  CHECK(census.walls[0].labels == std::array<int32_t, 2>{0, 1});
  CHECK(census.walls[0].faces == 10);
  CHECK(census.walls[0].area_world == Approx(5));
  CHECK(census.walls[2].labels == std::array<int32_t, 2>{1, 2});
  CHECK(census.walls[2].faces == 2);
  CHECK(census.walls[2].area_world == Approx(1));
  CHECK(census.curve_edges == 4);
  CHECK(census.corners == 0);
  CHECK(census.duplicate_faces == 0);
  CHECK(census.coincident_vertices == 0);
  CHECK(census.every_region_closed);
  CHECK(census.is_sound());
}

TEST_CASE("region census: a box in a box makes a hollow of the outer one", "[regions][unit]") {
  const RegionCensus census = census_of(cube_in_a_hollow());
  REQUIRE(census.regions.size() == 2);
  const RegionCounts &outer = census.regions[0], &inner = census.regions[1];
  CHECK(outer.components == 2);
  CHECK(outer.faces == 120);
  CHECK(outer.vertices == 64);
  CHECK(outer.volume_world == Approx(26));
  CHECK(outer.area_world == Approx(60));
  CHECK(outer.genus == 0);
  CHECK(inner.components == 1);
  CHECK(inner.volume_world == Approx(1));
  CHECK(census.walls.size() == 2);
  CHECK(census.curve_edges == 0);
  CHECK(census.is_sound());
}

TEST_CASE("region census: three boxes around an edge have curves that meet in its ends", "[regions][unit]") {
  const RegionCensus census = census_of(mesh_of(LabelledCubes{{2, 2, 1}, {1, 2, 3, 3}}));
  REQUIRE(census.regions.size() == 3);
  CHECK(census.regions[2].faces == 20);
  CHECK(census.regions[2].vertices == 12);
  CHECK(census.regions[2].volume_world == Approx(2));
  CHECK(census.walls.size() == 6);
  CHECK(census.curve_edges == 10);
  CHECK(census.corners == 2);
  CHECK(census.is_sound());
}

TEST_CASE("region census: without a face of their wall both regions are open", "[regions][unit]") {
  TriangleMesh mesh = two_cubes();
  remove_face(mesh, face_between(mesh, {1, 2}));
  const RegionCensus census = census_of(mesh);
  for (const RegionCounts& region : census.regions) {
    CHECK_FALSE(region.closed);
    CHECK(region.open_edges == 3);
    CHECK(region.genus == -1);
  }
  CHECK_FALSE(census.every_region_closed);
}

TEST_CASE("region census: without a face of its own one region is open, and the other is not", "[regions][unit]") {
  TriangleMesh mesh = two_cubes();
  remove_face(mesh, face_between(mesh, {2, 0}));
  const RegionCensus census = census_of(mesh);
  CHECK(census.regions[0].closed);
  CHECK_FALSE(census.regions[1].closed);
  CHECK(census.regions[1].open_edges == 3);
  CHECK_FALSE(census.every_region_closed);
}

TEST_CASE("region census: a face that is the wrong way around is inconsistent on its three edges", "[regions][unit]") {
  TriangleMesh mesh = two_cubes();
  std::swap(mesh.triangles[face_between(mesh, {1, 0})][1], mesh.triangles[face_between(mesh, {1, 0})][2]);
  const RegionCensus census = census_of(mesh);
  CHECK(census.regions[0].inconsistent_edges == 3);
  CHECK(census.regions[0].open_edges == 0);
  CHECK_FALSE(census.regions[0].closed);
  CHECK(census.regions[1].closed);
}

TEST_CASE("region census: a doubled wall is found on the same vertices and on copies of them", "[regions][unit]") {
  const RegionCensus doubled = census_of(two_cubes_of_two_walls());
  CHECK(doubled.every_region_closed);
  CHECK(doubled.duplicate_faces == 2);
  CHECK(doubled.coincident_vertices == 0);
  CHECK_FALSE(doubled.is_sound());

  const TriangleMesh whole = two_cubes();
  TriangleMesh apart = region_of(whole, 1);
  const TriangleMesh other = region_of(whole, 2);
  const uint32_t first = uint32_t(apart.vertices.size());
  apart.regions.labels.assign(apart.triangles.size(), {1, 0});
  apart.vertices.insert(apart.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& [a, b, c] : other.triangles) {
    apart.triangles.push_back({first + a, first + b, first + c});
    apart.regions.labels.push_back({2, 0});
  }
  const RegionCensus copied = census_of(apart);
  CHECK(copied.every_region_closed);
  CHECK(copied.duplicate_faces == 2);
  CHECK(copied.coincident_vertices == 4);
  CHECK(copied.curve_edges == 0);
  CHECK_FALSE(copied.is_sound());
}

TEST_CASE("region census: boxes of one region may touch in a vertex or along an edge", "[regions][unit]") {
  const RegionCensus vertex = census_of(cubes_that_touch_in_a_vertex());
  REQUIRE(vertex.regions.size() == 1);
  CHECK(vertex.regions[0].closed);
  CHECK(vertex.regions[0].touching_vertices == 1);
  CHECK(vertex.regions[0].vertices == 15);
  CHECK(vertex.regions[0].components == 2);
  CHECK(vertex.regions[0].genus == 0);
  CHECK(vertex.regions[0].volume_world == Approx(2));
  CHECK(vertex.is_sound());

  const RegionCensus edge = census_of(mesh_of(LabelledCubes{{2, 2, 1}, {1, 0, 0, 1}}));
  CHECK(edge.regions[0].open_edges == 0);
  CHECK(edge.regions[0].closed);
  CHECK(edge.regions[0].components == 2);
  CHECK(edge.regions[0].genus == 0);
  CHECK(edge.regions[0].touching_vertices == 2);
  CHECK(edge.curve_edges == 1);
  CHECK(edge.corners == 2);
}

TEST_CASE("region census: regions in faces that are all turned are inside out", "[regions][unit]") {
  TriangleMesh mesh = two_cubes();
  for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  const RegionCensus census = census_of(mesh);
  CHECK(census.every_region_closed);
  CHECK(census.inside_out_regions == 2);
  CHECK(census.regions[0].volume_world == Approx(-1));
  CHECK_FALSE(census.is_sound());
}

TEST_CASE("region census: faces that cross are counted", "[regions][unit]") {
  TriangleMesh mesh = two_cubes();
  for (WorldPoint& p : mesh.vertices)
    if (p.x == 2) p.x = .5;  // the second box folds back into the first one
  const RegionCensus census = census_of(mesh);
  CHECK(census.every_region_closed);
  CHECK(census.regions[1].volume_world == Approx(-.5));
  CHECK(census.intersecting_pairs > 0);
  CHECK_FALSE(census.is_sound());
}

TEST_CASE("region census: another background is no region", "[regions][unit]") {
  TriangleMesh mesh = two_cubes();
  for (auto& labels : mesh.regions.labels)
    if (labels[1] == 0) labels[1] = 7;
  mesh.regions.background = 7;
  const RegionCensus census = census_of(mesh);
  CHECK(census.regions.size() == 2);
  CHECK(census.background == 7);
  CHECK(census.walls[1].labels == std::array<int32_t, 2>{1, 7});
}

TEST_CASE("region census: numbers do not depend on threads", "[regions][unit]") {
  const TriangleMesh mesh = mesh_of(LabelledCubes{{3, 2, 2}, {1, 2, 3, 4, 5, 6, 3, 3, 2, 1, 4, 4}});
  Context one, four;
  one.threads = 1;
  four.threads = 4;
  const RegionCensus a = take_region_census(mesh, one), b = take_region_census(mesh, four);
  REQUIRE(a.regions.size() == b.regions.size());
  for (size_t i = 0; i < a.regions.size(); ++i) CHECK(a.regions[i].volume_world == b.regions[i].volume_world);
  CHECK(a.walls.size() == b.walls.size());
}

TEST_CASE("region census: what is no complex of regions is refused", "[regions][unit]") {
  const auto refusal = [](const TriangleMesh& mesh) { return message_of(ErrorCode::usage, [&] { census_of(mesh); }); };
  TriangleMesh mesh = two_cubes();
  mesh.regions.labels.clear();
  CHECK(contains(refusal(mesh), "no regions"));
  mesh = two_cubes();
  mesh.regions.labels.pop_back();
  CHECK(contains(refusal(mesh), "22 triangles, and labels of 21"));
  mesh = two_cubes();
  mesh.triangles[0][0] = 12;
  CHECK(contains(refusal(mesh), "vertex 12"));
  mesh = two_cubes();
  mesh.vertices[5].y = NAN;
  CHECK(contains(refusal(mesh), "vertex 5 is not finite"));
}

TEST_CASE("region census: sheets bound no region, whether they lie in one or outside", "[regions][unit]") {
  TriangleMesh mesh = two_cubes();
  const RegionCensus before = census_of(mesh);
  for (const int32_t label : {1, 0}) {
    const auto first = uint32_t(mesh.vertices.size());
    const double x = label == 1 ? .25 : 9;
    mesh.vertices.insert(mesh.vertices.end(), {{x, .25, .25}, {x, .75, .25}, {x, .25, .75}});
    mesh.triangles.push_back({first, first + 1, first + 2});
    mesh.regions.labels.push_back({label, label});
  }
  const RegionCensus census = census_of(mesh);
  CHECK(census.is_sound());
  CHECK(census.regions.size() == before.regions.size());
  CHECK(census.regions[0].faces == before.regions[0].faces);
  CHECK(census.regions[0].volume_world == Approx(before.regions[0].volume_world));
  CHECK(census.walls.size() == before.walls.size() + 2);
  CHECK(region_of(mesh, 1).triangles.size() == size_t(before.regions[0].faces));
  mesh.triangles.erase(mesh.triangles.begin(), mesh.triangles.end() - 2);
  mesh.regions.labels.erase(mesh.regions.labels.begin(), mesh.regions.labels.end() - 2);
  CHECK(census_of(mesh).is_sound());
  CHECK(census_of(mesh).regions.empty());
}

TEST_CASE("region of: each of two boxes is a closed mesh with its vertices in order", "[regions][unit]") {
  const TriangleMesh whole = two_cubes();
  for (const int32_t label : {1, 2}) {
    const TriangleMesh region = region_of(whole, label);
    CHECK(region.regions.empty());
    CHECK(region.triangles.size() == 12);
    REQUIRE(region.vertices.size() == 8);
    CHECK(check_mesh(region).is_closed_manifold());
    size_t next = 0;  // in the whole mesh
    for (const WorldPoint& p : region.vertices) {
      const auto found = std::find_if(whole.vertices.begin() + int64_t(next), whole.vertices.end(),
                                      [&](const WorldPoint& q) { return std::memcmp(&p, &q, sizeof p) == 0; });
      REQUIRE(found != whole.vertices.end());
      next = size_t(found - whole.vertices.begin()) + 1;
    }
    const WorldPoint middle{label - .5, .5, .5};
    for (size_t t = 0; t < region.triangles.size(); ++t) {
      const WorldPoint n = normal_of(region, t), &p = region.vertices[region.triangles[t][0]];
      CHECK(n.x * (p.x - middle.x) + n.y * (p.y - middle.y) + n.z * (p.z - middle.z) > 0);
    }
  }
}

TEST_CASE("region of: where a region touches itself each fan has a vertex of its own", "[regions][unit]") {
  const TriangleMesh whole = cubes_that_touch_in_a_vertex();
  const TriangleMesh region = region_of(whole, 1);
  CHECK(whole.vertices.size() == 15);
  REQUIRE(region.vertices.size() == 16);
  const MeshTopology topology = check_mesh(region);
  CHECK(topology.is_closed_manifold());
  CHECK(topology.components == 2);
  const auto at_middle = [](const WorldPoint& p) { return p.x == 1 && p.y == 1 && p.z == 1; };
  const auto first = std::find_if(region.vertices.begin(), region.vertices.end(), at_middle);
  CHECK(std::count_if(region.vertices.begin(), region.vertices.end(), at_middle) == 2);
  CHECK(at_middle(*(first + 1)));
}

TEST_CASE("region of: boxes that touch along an edge are parted there", "[regions][unit]") {
  const TriangleMesh region = region_of(mesh_of(LabelledCubes{{2, 2, 1}, {1, 0, 0, 1}}), 1);
  CHECK(region.vertices.size() == 16);
  CHECK(check_mesh(region).is_closed_manifold());
  CHECK(check_mesh(region).components == 2);
}

TEST_CASE("region of: the outer of two boxes keeps its hollow", "[regions][unit]") {
  const MeshTopology topology = check_mesh(region_of(cube_in_a_hollow(), 1));
  CHECK(topology.is_closed_manifold());
  CHECK(topology.components == 2);
}

TEST_CASE("region of: attributes go along, and normals turn with their faces", "[regions][unit]") {
  TriangleMesh whole = two_cubes();
  const size_t faces = whole.triangles.size();
  whole.attributes = {attribute("weight", AttributeDomain::vertex, 1, whole.vertices.size()),
                      attribute("part", AttributeDomain::face, 2, faces),
                      attribute(kUvName, AttributeDomain::corner, 2, 3 * faces),
                      attribute(kNormalName, AttributeDomain::corner, 3, 1)};
  whole.attributes[3].index.assign(3 * faces, 0);
  whole.gap.assign(whole.vertices.size(), 0);
  whole.gap[3] = 1;
  const TriangleMesh region = region_of(whole, 2);
  REQUIRE(region.attributes.size() == 4);
  const Attribute &weight = region.attributes[0], &part = region.attributes[1], &uv = region.attributes[2],
                  &normal = region.attributes[3];
  REQUIRE(weight.values.size() == region.vertices.size());
  for (size_t v = 0; v < region.vertices.size(); ++v) {
    const WorldPoint &p = region.vertices[v], &q = whole.vertices[size_t(weight.values[v])];
    CHECK((p.x == q.x && p.y == q.y && p.z == q.z));
    CHECK(int(region.gap[v]) == int(weight.values[v] == 3));
  }
  REQUIRE(part.values.size() == 2 * region.triangles.size());
  for (size_t t = 0; t < region.triangles.size(); ++t) {
    const size_t face = size_t(part.values[2 * t]) / 2;
    const bool is_turned = whole.regions.labels[face][1] == 2;
    for (size_t i = 0; i < 3; ++i) {
      const size_t was = size_t(uv.values[2 * uv.index[3 * t + i]]) / 2;
      CHECK(was / 3 == face);
      CHECK(double(whole.triangles[face][was % 3]) == weight.values[region.triangles[t][i]]);
      CHECK(normal.values[3 * normal.index[3 * t + i] + 2] == (is_turned ? -2 : 2));
    }
  }
  CHECK(normal.values.size() == 6);
}

TEST_CASE("region of: a label that no face has is refused with those there are", "[regions][unit]") {
  TriangleMesh mesh = two_cubes();
  mesh.regions.names = {{2, "bone"}};
  const auto refusal = [&](int32_t label) { return message_of(ErrorCode::usage, [&] { region_of(mesh, label); }); };
  CHECK(contains(refusal(3), "no region 3; its regions are 1, 2 (bone)"));
  CHECK(contains(refusal(0), "no region 0"));
  mesh.regions.labels.clear();
  CHECK(contains(refusal(1), "no regions"));
}
