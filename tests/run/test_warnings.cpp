// What a run says of its result, and the ways out that it names.
#include <cmath>

#include "isoshell/readable.h"
#include "isoshell/run/run.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

RunResult run_of(const TriangleSoup& soup, const RemeshOptions& options, const char* gates = "") {
  CpuContext context;
  RunRequest request;
  request.options = requested_options(options);
  request.gates = parse_gates(gates);
  return run(input_of(soup, "shape"), request, context);
}

std::string warnings_of(const RunResult& result) {
  std::string all;
  for (const std::string& text : result.record.warnings) all += text + "\n";
  return all;
}

TriangleSoup moved(TriangleSoup soup, const WorldPoint& by) {
  for (WorldPoint& p : soup.vertices) p = {p.x + by.x, p.y + by.y, p.z + by.z};
  return soup;
}

/// Two boxes with a wall in common, with a corner far out each: no edges as long as others follow their spikes, and so
/// many faces have these corners that they are not pulled back.
TriangleSoup boxes_with_spikes() {
  TriangleSoup left = shapes::box({0, 0, 0}, {1, 1, 1}), right = shapes::box({1, 0, 0}, {2, 1, 1});
  for (WorldPoint& p : left.vertices)
    if (p.x == 0 && p.y == 0 && p.z == 1) p.y = 2048;
  for (WorldPoint& p : right.vertices)
    if (p.x == 2 && p.y == 0 && p.z == 0) p.y = 2048;
  return shapes::together(left, right);
}

/// A bar whose section has a corner of so many degrees.
TriangleSoup blade(double degrees) {
  TriangleSoup soup = shapes::box({0, 0, 0}, {1, 1, 1});
  const double rise = std::tan(degrees * std::acos(-1) / 180);
  for (WorldPoint& p : soup.vertices) p = {p.x, p.y * (p.x == 0 ? 1e-3 : rise), p.z};
  return soup;
}

}  // namespace

TEST_CASE("warnings: places have as many digits as the size of the surface needs", "[run]") {
  CHECK(readable_place({1.23456789, -20.5, 0}, 100) == "1.23457 -20.5 0");
  CHECK(readable_place({441906.125, 6329781.5, 12.3456789}, 10) == "441906.125 6329781.5 12.34568");
  CHECK(readable_place({1e8 + 0.25, 0, 0}, 1) == "100000000.25 0 0");
  CHECK(readable_place({5, 5, 5}, 0) == "5 5 5");
  CHECK(exact_place({500000, -0.1, 1e-300}) == "500000 -0.1 1e-300");
  RemeshOptions few;
  few.vertices = 100;
  const TriangleSoup wire = moved(shapes::torus(1, .02, 200, 12), {441906, 6329781, 0});
  const std::string said = warnings_of(run_of(wire, few));
  CHECK(contains(said, " below 30 degrees: "));
  CHECK((contains(said, " 6329780.") || contains(said, " 6329781.")));
}

TEST_CASE("warnings: a surface that is inside out is turned with a word", "[run]") {
  RemeshOptions few;
  few.vertices = 300;
  const TriangleSoup torus = shapes::torus(3, 1, 48, 24);
  CHECK(warnings_of(run_of(torus, few)).empty());
  const RunResult turned = run_of(shapes::inside_out(torus), few);
  CHECK(contains(warnings_of(turned), "shape: 1 closed components that were inside out, turned outward"));
  CHECK(turned.record.report.input.united.turned_components == 1);
  CHECK(contains(warnings_of(run_of(shapes::inside_out(shapes::box({0, 0, 0}, {1, 1, 1})), few)), "turned outward"));
  const TriangleSoup two = shapes::together(moved(torus, {9, 0, 0}), shapes::inside_out(torus));
  CHECK(contains(warnings_of(run_of(two, few)), "1 closed components that were inside out"));
}

TEST_CASE("warnings: another number of vertices than was asked for is said, and missed by the gate beyond a tenth",
          "[run]") {
  RemeshOptions options;
  options.vertices = 50;
  options.regions = "components";
  const RunResult regions = run_of(boxes_with_spikes(), options, "count");
  CHECK(contains(warnings_of(regions), " vertices instead of 50: the curves between its regions"));
  REQUIRE_FALSE(regions.missed_gates.empty());
  CHECK(contains(regions.missed_gates.back(), "count: the result has "));
  options.regions = "";
  options.vertices = 200;
  CHECK(run_of(shapes::torus(3, 1, 48, 24), options, "count").missed_gates.empty());
}

TEST_CASE("warnings: small angles beside creases name the options that give creases up", "[run]") {
  RemeshOptions options;
  options.vertices = 400;
  const std::string with_creases = warnings_of(run_of(blade(12), options));
  CHECK(contains(with_creases, " below 30 degrees: "));
  CHECK(contains(with_creases, "--features off"));
  CHECK(contains(with_creases, "--features DEG"));
  options.vertices = 100;
  const std::string without = warnings_of(run_of(shapes::torus(1, .02, 200, 12), options));
  CHECK(contains(without, "more --vertices make better triangles"));
  CHECK_FALSE(contains(without, "--features"));
}
