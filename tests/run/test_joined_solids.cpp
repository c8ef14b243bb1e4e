// Whole runs of closed parts that pass through or touch each other: they are one solid with its creases, or the run
// says why not.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "isoshell/run/run.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;
using shapes::box;
using shapes::together;
using Json = nlohmann::json;

namespace {

TriangleSoup crossing_bars() { return together(box({0, 2, 0}, {6, 4, 2}), box({2, 0, .5}, {4, 6, 1.5})); }

TriangleSoup hollow_box(const WorldPoint& lo, double side, double wall) {
  const double in = wall, out = side - wall;
  return together(box(lo, {lo.x + side, lo.y + side, lo.z + side}),
                  shapes::inside_out(box({lo.x + in, lo.y + in, lo.z + in}, {lo.x + out, lo.y + out, lo.z + out})));
}

/// Two bars that overlap and are one component: a tube joins the end of the first with the beginning of the second.
TriangleSoup overlapping_bars() {
  TriangleSoup bars = together(box({0, 0, 0}, {6, 2, 2}), box({1, 1, 1}, {7, 3, 3}));
  const std::array<uint32_t, 3> end{1, 3, 7}, beginning{8, 14, 10}, facing{8, 10, 14};
  const auto is_joined = [&](const std::array<uint32_t, 3>& t) { return t == end || t == beginning; };
  bars.triangles.erase(std::remove_if(bars.triangles.begin(), bars.triangles.end(), is_joined), bars.triangles.end());
  REQUIRE(bars.triangles.size() == 22);
  for (size_t i = 0; i < 3; ++i) {
    const size_t j = (i + 1) % 3;
    bars.triangles.push_back({end[i], end[j], facing[j]});
    bars.triangles.push_back({end[i], facing[j], facing[i]});
  }
  return bars;
}

RunResult result_of(const TriangleSoup& parts, Boundary boundary = Boundary::close) {
  CpuContext context;
  RunRequest request;
  RemeshOptions options;
  options.vertices = 1500;
  options.boundary = boundary;
  if (boundary == Boundary::keep) options.closing_vox = 0;
  request.options = requested_options(options);
  return run(input_of(parts, "parts"), request, context);
}

Json united(const RunResult& result) { return Json::parse(statistics_json(result.record))["input"]["united"]; }

int64_t count_warnings(const RunResult& result, const std::string& part) {
  return std::count_if(result.record.warnings.begin(), result.record.warnings.end(),
                       [&](const std::string& text) { return text.find(part) != std::string::npos; });
}

void check_given_up(const RunResult& result, const std::string& why) {
  CHECK(united(result)["not_joined"] == why);
  CHECK(united(result)["left_components"] == 0);
  CHECK(count_warnings(result, "are not joined as one mesh") == 1);
  CHECK(count_warnings(result, why) == 1);
  CHECK(result.record.topology->is_closed_manifold());
}

}  // namespace

TEST_CASE("joined solids: bars that cross are joined beside a hollow box, which keeps its hollow", "[run]") {
  const RunResult result = result_of(together(crossing_bars(), hollow_box({8, 0, 0}, 3, .8)));
  CHECK(result.record.report.features.kept);
  CHECK(result.record.topology->is_closed_manifold());
  CHECK(result.record.topology->components == 3);
  CHECK(united(result)["left_components"] == 1);
  CHECK(united(result)["inner_surfaces"] == 1);
  CHECK(united(result)["not_joined"].is_null());
  CHECK(count_warnings(result, "1 open or inward looking components left as they are") == 1);
  CHECK(count_warnings(result, "not joined") == 0);
}

TEST_CASE("joined solids: bars one of which is hollow are joined where the other does not reach the hollow", "[run]") {
  const TriangleSoup hollow = shapes::inside_out(box({4.6, 2.4, .4}, {5.6, 3.6, 1.6}));
  const RunResult result = result_of(together(crossing_bars(), hollow));
  CHECK(result.record.report.features.kept);
  CHECK(result.record.topology->components == 2);
  CHECK(united(result)["left_components"] == 1);
}

TEST_CASE("joined solids: a bar that passes into a hollow is not joined, and the warning says where", "[run]") {
  const RunResult result = result_of(together(crossing_bars(), shapes::inside_out(box({1, 2.2, .2}, {5, 3.8, 1.8}))));
  check_given_up(result, "a component that is open or looks inward meets them");
  const Json at = united(result)["not_joined_at"];
  REQUIRE(at.is_array());
  CHECK(at[0] >= 1);
  CHECK(at[0] <= 5);
}

TEST_CASE("joined solids: a hollow that another part fills keeps them from being joined", "[run]") {
  check_given_up(result_of(together(crossing_bars(), shapes::inside_out(box({2.5, 2.5, .8}, {3.5, 3.5, 1.2})))),
                 "a component that is open or looks inward lies in several of them");
}

TEST_CASE("joined solids: parts that look inward are not joined", "[run]") {
  check_given_up(result_of(shapes::inside_out(crossing_bars())), "fewer than two of them look outward");
}

TEST_CASE("joined solids: a part that crosses itself is not joined", "[run]") {
  check_given_up(result_of(together(overlapping_bars(), box({3, -1, 1.2}, {4, 5, 1.6}))),
                 "what bounds both is not closed, as where a component crosses itself");
}

TEST_CASE("joined solids: bars that cross are joined beside a sheet whose border is kept", "[run]") {
  TriangleSoup sheet = box({8, 0, 0}, {11, 3, 3});
  sheet.triangles.resize(2);
  const RunResult result = result_of(together(crossing_bars(), sheet), Boundary::keep);
  CHECK(result.record.report.features.kept);
  CHECK(result.record.topology->components == 2);
  CHECK(result.record.topology->boundary_loops == 1);
  CHECK(united(result)["left_components"] == 1);
  CHECK(result.record.report.optimize.self_intersections == 0);
}
