// Conditions on the result: what their list means, and which a record misses.
#include "isoshell/error.h"
#include "isoshell/run/gates.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;

namespace {

std::string refusal(const std::string& list) {
  return message_of(ErrorCode::usage, [&] { parse_gates(list); });
}

/// A ball, as measured.
RunRecord good_record() {
  RunRecord record;
  record.report.is_optimized = true;
  record.topology.emplace();
  record.topology->closed = record.topology->manifold = true;
  record.topology->components = 1;
  record.topology->genus = 0;
  record.quality.emplace();
  record.quality->theta_min_deg = 35;
  record.distance.emplace();
  record.distance->to_reference.max = 0.25;
  record.distance->from_reference.max = 0.5;
  return record;
}

}  // namespace

TEST_CASE("gates: a list sets them, an empty one none", "[gates]") {
  CHECK_FALSE(parse_gates("").any());
  const Gates g = parse_gates(
      "closed,manifold,no-self-intersections,genus=3,components=2,boundary-loops=4,min-angle=20.5,max-deviation=0.1,"
      "normal-deviation=1.5,features");
  CHECK(g.closed);
  CHECK(g.manifold);
  CHECK(g.no_self_intersections);
  CHECK(g.genus == 3);
  CHECK(g.components == 2);
  CHECK(g.boundary_loops == 4);
  CHECK(g.min_angle_deg == 20.5);
  CHECK(g.max_deviation_world == 0.1);
  CHECK(g.normal_deviation_deg == 1.5);
  CHECK(g.features);
  CHECK(g.needs_distance());
  CHECK_FALSE(parse_gates("features").needs_distance());
  CHECK(parse_gates("closed,genus=3").requested == std::vector<std::string>{"closed", "genus=3"});
}

TEST_CASE("gates: what is no gate is refused with those there are", "[gates]") {
  CHECK(contains(refusal("watertight"), "gates are closed, manifold, no-self-intersections, genus=G"));
  CHECK(contains(refusal("genus"), "genus=G"));
  CHECK(contains(refusal("closed=1"), "gates are closed"));
  CHECK(contains(refusal("genus=-1"), "whole number"));
  CHECK(contains(refusal("min-angle=61"), "0 to 60"));
  CHECK(contains(refusal("max-deviation=-1"), "--require max-deviation"));
  CHECK(contains(refusal("normal-deviation=91"), "0 to 90"));
  CHECK(contains(refusal("features=1"), "gates are closed"));
}

TEST_CASE("gates: a record that meets all of them misses none", "[gates]") {
  const Gates all =
      parse_gates("closed,manifold,no-self-intersections,genus=0,components=1,min-angle=35,max-deviation=0.5");
  CHECK(missed_gates(all, good_record()).empty());
  const RunRecord nothing;
  CHECK(missed_gates(Gates{}, nothing).empty());
}

TEST_CASE("gates: each that is missed is one sentence with what is there", "[gates]") {
  RunRecord bad = good_record();
  bad.topology->closed = false;
  bad.topology->boundary_loops = 2;
  bad.topology->genus = -1;
  bad.topology->components = 4;
  bad.report.optimize.self_intersections = 1;
  CHECK(missed_gates(
            parse_gates("closed,manifold,no-self-intersections,genus=0,components=1,min-angle=36,max-deviation=0.4"),
            bad) ==
        std::vector<std::string>{
            "closed: the mesh has 2 open boundaries",
            "manifold: the mesh is not a closed 2-manifold",
            "no-self-intersections: 1 pair intersect",
            "genus=0: the mesh has none, it is no closed 2-manifold",
            "components=1: the mesh has 4",
            "min-angle=36: the smallest angle is 35",
            "max-deviation=0.4: the result is up to 0.25 from the input, the input up to 0.5 from the result",
        });
  bad.report.is_optimized = false;
  CHECK(contains(missed_gates(parse_gates("no-self-intersections"), bad).at(0), "was not tested"));
}

TEST_CASE("gates: a result that intersects itself is missed once, unless that is allowed", "[gates]") {
  RunRecord bad = good_record();
  bad.report.optimize.self_intersections = 3;
  Gates gates;
  CHECK_FALSE(gates.any());
  CHECK(missed_gates(gates, bad) ==
        std::vector<std::string>{
            "the result intersects itself in 3 pairs of triangles; --allow-intersections takes it as it is"});
  CHECK(missed_gates(parse_gates("no-self-intersections"), bad) ==
        std::vector<std::string>{"no-self-intersections: 3 pairs intersect"});
  gates.allow_intersections = true;
  CHECK(missed_gates(gates, bad).empty());
}

TEST_CASE("gates: a lost curve is named, and the larger mean of normals counts", "[gates]") {
  RunRecord record = good_record();
  CHECK(missed_gates(parse_gates("features,normal-deviation=0"), record).empty());
  record.distance->normal_to_reference = {.5, 40};
  record.distance->normal_from_reference = {1.5, 60};
  CHECK(missed_gates(parse_gates("normal-deviation=1.5"), record).empty());
  CHECK(missed_gates(parse_gates("normal-deviation=1"), record) ==
        std::vector<std::string>{"normal-deviation=1: normals of the result deviate by 0.5 degrees on average from the "
                                 "input's, and those of the input by 1.5 from the result's"});
  record.report.features.given_up = "holes were capped";
  CHECK(missed_gates(parse_gates("features"), record) == std::vector<std::string>{"features: holes were capped"});
  record.report.features.lost = {{3, "crease", 2, {1, 2, 3}, "holes were capped"}};
  CHECK(missed_gates(parse_gates("features"), record) ==
        std::vector<std::string>{"features: 1 curve of the input is lost; the first, a crease of length 2 from 1 2 3: "
                                 "holes were capped"});
}

TEST_CASE("gates: a number of vertices is met to a tenth, and is a question for runs alone", "[gates]") {
  RunRecord record = good_record();
  const Gates gates = parse_gates("count");
  CHECK(missed_gates(gates, record) == std::vector<std::string>{"count: no number of vertices was asked for"});
  record.report.count = {200, 180, "its walls are as they came in"};
  CHECK(missed_gates(gates, record).empty());
  record.report.count.made = 220;
  CHECK(missed_gates(gates, record).empty());
  record.report.count.made = 221;
  CHECK(missed_gates(gates, record) ==
        std::vector<std::string>{"count: the result has 221 vertices instead of 200: its walls are as they came in"});
  CHECK(contains(message_of(ErrorCode::usage, [&] { check_gates_of_mesh(gates, true); }),
                 "--require count is for a run, which knows what was asked for"));
}

TEST_CASE("gates: triangles that the numbers of a file do not hold are always missed", "[gates]") {
  RunRecord record = good_record();
  record.files.push_back({"far.stl", "stl", {}});
  CHECK(missed_gates(Gates{}, record).empty());
  record.files[0].held.lost_triangles = 3;
  Gates as_it_is;
  as_it_is.allow_intersections = true;
  CHECK(missed_gates(as_it_is, record) ==
        std::vector<std::string>{
            "far.stl: its numbers are too coarse for 3 triangles, which tilt by more than 60 degrees "
            "or lose their area; --recenter auto subtracts an offset from them, and PLY and OBJ files have "
            "finer ones"});
}

TEST_CASE("gates: an open mesh is a manifold with the borders that were kept, and closed it is not", "[gates]") {
  RunRecord open = good_record();
  open.topology->closed = false;
  open.topology->boundary_loops = 2;
  CHECK(missed_gates(parse_gates("boundary-loops=2"), open).empty());
  CHECK(missed_gates(parse_gates("boundary-loops=0,manifold"), open) ==
        std::vector<std::string>{"manifold: the mesh is not a closed 2-manifold", "boundary-loops=0: the mesh has 2"});
  open.report.features.border_loops = 2;
  CHECK(missed_gates(parse_gates("manifold,boundary-loops=2"), open).empty());
  CHECK(missed_gates(parse_gates("closed"), open).size() == 1);
  open.report.features.border_loops = 3;
  CHECK(missed_gates(parse_gates("manifold"), open) ==
        std::vector<std::string>{"manifold: the mesh is not a 2-manifold with the borders that were kept"});
}

TEST_CASE("gates: a record without what they ask for is refused", "[gates]") {
  const RunRecord nothing;
  CHECK_THROWS_AS(missed_gates(parse_gates("closed"), nothing), Error);
  RunRecord record = good_record();
  record.distance.reset();
  CHECK_THROWS_AS(missed_gates(parse_gates("max-deviation=1"), record), Error);
  CHECK_THROWS_AS(missed_gates(parse_gates("normal-deviation=1"), record), Error);
}
