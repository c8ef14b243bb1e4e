// What a certificate says of a mesh whose faces part regions, and which conditions on it are met.
#include <utility>

#include "isoshell/error.h"
#include "isoshell/run/mesh_info.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "unit/region_cubes.h"

using namespace isoshell;

namespace {

MeshInfo info_of(TriangleMesh mesh, const std::string& gates = "") {
  TriangleSoup soup;
  soup.vertices = std::move(mesh.vertices);
  soup.triangles = std::move(mesh.triangles);
  soup.regions = std::move(mesh.regions);
  Context context;
  return mesh_info([&] { return input_of(std::move(soup), "cubes"); }, {}, parse_gates(gates), context);
}

std::vector<std::string> missed_of(TriangleMesh mesh, const std::string& gates) {
  return info_of(std::move(mesh), gates).missed_gates;
}

/// A run on boxes whose result is those of others.
RunRecord record_of(const LabelledCubes& before, const LabelledCubes& after) {
  TriangleMesh given = mesh_of(before);
  TriangleSoup soup;
  soup.vertices = std::move(given.vertices);
  soup.triangles = std::move(given.triangles);
  soup.regions = std::move(given.regions);
  soup.regions.names = {{2, "bone"}, {3, "skin"}};
  RunRecord record;
  record.topology.emplace();
  record.quality.emplace();
  record.input = input_of(std::move(soup), "cubes").facts;
  Context context;
  record.regions = take_region_census(mesh_of(after), context);
  return record;
}

TriangleMesh folded_cubes() {
  TriangleMesh mesh = two_cubes();
  for (WorldPoint& p : mesh.vertices)
    if (p.x == 2) p.x = .5;
  return mesh;
}

}  // namespace

TEST_CASE("region gates: boxes that share a wall meet all that is asked of regions", "[gates][regions]") {
  CHECK(missed_of(two_cubes(), "regions,closed,manifold,no-self-intersections").empty());
}

TEST_CASE("region gates: what is missed is one sentence with what is there", "[gates][regions]") {
  using Sentences = std::vector<std::string>;
  TriangleMesh open = two_cubes();
  open.regions.names = {{2, "bone"}};
  remove_face(open, face_between(open, {2, 0}));
  CHECK(missed_of(open, "regions") == Sentences{"regions: region 2 (bone) is not closed: 3 edges have another number "
                                                "of its faces than two"});
  CHECK(missed_of(open, "closed,manifold").size() == 2);
  CHECK(missed_of(two_cubes_of_two_walls(), "regions") == Sentences{"regions: 2 faces are there twice"});
  REQUIRE(missed_of(folded_cubes(), "regions").size() == 1);
  CHECK(contains(missed_of(folded_cubes(), "regions")[0], "of triangles intersect"));
  TriangleMesh inverted = two_cubes();
  for (auto& t : inverted.triangles) std::swap(t[1], t[2]);
  CHECK(missed_of(inverted, "regions") == Sentences{"regions: 2 regions are inside out"});
  TriangleMesh turned = two_cubes();
  std::swap(turned.triangles[0][1], turned.triangles[0][2]);
  REQUIRE(missed_of(turned, "regions").size() == 1);
  CHECK(contains(missed_of(turned, "regions")[0], "with two faces that pass it the same way"));
}

TEST_CASE("region gates: a region that touches itself in a vertex is closed and no manifold", "[gates][regions]") {
  const TriangleMesh mesh = mesh_of(LabelledCubes{{2, 2, 2}, {1, 0, 0, 0, 0, 0, 0, 1}});
  CHECK(missed_of(mesh, "regions,closed").empty());
  CHECK(missed_of(mesh, "manifold") == std::vector<std::string>{"manifold: region 1 touches itself in 1 vertex"});
}

TEST_CASE("region gates: a mesh without regions misses them", "[gates][regions]") {
  TriangleMesh mesh = two_cubes();
  mesh.regions = {};
  CHECK(missed_of(mesh, "regions") == std::vector<std::string>{"regions: the mesh has no regions"});
  CHECK_FALSE(info_of(mesh).regions.has_value());
  CHECK(contains(mesh_info_json(info_of(mesh)), "\"regions\": null"));
}

TEST_CASE("region gates: a run's result is judged by its regions", "[gates][regions]") {
  Context context;
  RunRecord record;
  record.topology.emplace();
  record.quality.emplace();
  CHECK(missed_gates(parse_gates("regions"), record).size() == 1);
  record.regions = take_region_census(two_cubes(), context);
  CHECK(missed_gates(parse_gates("regions,closed,manifold,no-self-intersections"), record).empty());
  CHECK(contains(statistics_json(record), "\"every_region_closed\": true"));
  record.regions = take_region_census(folded_cubes(), context);
  CHECK(missed_gates(parse_gates("regions"), record).size() == 1);
  CHECK(missed_gates(parse_gates(""), record).size() == 1);
  Gates as_it_is;
  as_it_is.allow_intersections = true;
  CHECK(missed_gates(as_it_is, record).empty());
}

TEST_CASE("region gates: the certificate has each region and wall", "[mesh_info][regions]") {
  const std::string json = mesh_info_json(info_of(two_cubes()));
  CHECK(contains(json, "\"label\": 2"));
  CHECK(contains(json, "\"walls\""));
  CHECK(contains(json, "\"every_region_closed\": true"));
}

TEST_CASE("region gates: regions and walls that a run lost or made are named", "[gates][regions]") {
  const LabelledCubes row{{3, 1, 1}, {1, 2, 3}};
  const Gates adjacency = parse_gates("adjacency");
  CHECK(missed_gates(adjacency, record_of(row, row)).empty());
  CHECK(contains(statistics_json(record_of(row, row)), "\"walls_lost\": []"));
  const RunRecord lost = record_of(row, {{3, 1, 1}, {1, 2, 2}});
  CHECK(missed_gates(adjacency, lost) ==
        std::vector<std::string>{"adjacency: regions of the input are lost: 3 (skin); regions that touch in the input "
                                 "touch no more: 0 (background) and 3 (skin), 2 (bone) and 3 (skin)"});
  CHECK(contains(statistics_json(lost), "\"regions_lost\": [\n      {\n        \"label\": 3"));
  const std::vector<std::string> other = missed_gates(adjacency, record_of(row, {{3, 1, 1}, {1, 3, 2}}));
  REQUIRE(other.size() == 1);
  CHECK(contains(other[0], "touch no more: 1 and 2 (bone); regions touch that do not in the input: 1 and 3 (skin)"));
  RunRecord absorbed = record_of(row, row);
  absorbed.input.regions.absorbed_walls = {{1, 3}};
  CHECK(missed_gates(adjacency, absorbed).empty());
  CHECK(contains(statistics_json(absorbed), "\"walls_absorbed\": [\n      [\n        {\n          \"label\": 1"));
  RunRecord without = record_of(row, row);
  without.input.regions.walls.clear();
  CHECK(missed_gates(adjacency, without) == std::vector<std::string>{"adjacency: the input has no regions"});
  CHECK(contains(message_of(ErrorCode::usage, [&] { info_of(two_cubes(), "adjacency"); }), "is for a run"));
}

TEST_CASE("region gates: a region whose volume differs is told with both volumes", "[gates][regions]") {
  const LabelledCubes row{{3, 1, 1}, {1, 2, 3}};
  RunRecord record = record_of(row, row);
  CHECK(missed_gates(parse_gates("region-volume=.000001"), record).empty());
  CHECK(contains(statistics_json(record), "\"volumes_changed\": []"));
  record.input.regions.volume_world[2] = 2;
  CHECK(missed_gates(parse_gates("region-volume=50"), record).empty());
  CHECK(missed_gates(parse_gates("region-volume=49"), record) ==
        std::vector<std::string>{"region-volume=49: region 2 (bone) has 1 of 2, -50 %"});
  CHECK(contains(statistics_json(record), "\"change_pct\": -50"));
  CHECK(contains(missed_gates(parse_gates("region-volume=50"), record_of(row, {{3, 1, 1}, {1, 2, 2}}))[0],
                 "region 3 (skin) is lost"));
}

TEST_CASE("gates: the least angle between triangles with a common edge is told with its place", "[gates]") {
  CHECK(missed_of(two_cubes(), "min-dihedral=89.9").empty());
  const std::vector<std::string> missed = missed_of(two_cubes(), "min-dihedral=91");
  REQUIRE(missed.size() == 1);
  CHECK(contains(missed[0], "two triangles meet at 90 degrees near"));
  CHECK(contains(mesh_info_json(info_of(two_cubes())), "\"dihedral_min_deg\": 90"));
}
