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

/// One solid with its creases, of this volume and this many surfaces.
RunResult check_united(const TriangleSoup& parts, double volume_world, int64_t components, int64_t genus) {
  const RunResult result = result_of(parts);
  CHECK(united(result)["not_joined"].is_null());
  CHECK(united(result)["left_components"] == 0);
  CHECK(count_warnings(result, "joined as one mesh") == 0);
  CHECK(result.record.report.features.kept);
  CHECK(result.record.topology->is_closed_manifold());
  CHECK(result.record.topology->components == components);
  CHECK(result.record.topology->genus == genus);
  TriangleSoup made;
  made.vertices = result.mesh.vertices;
  made.triangles = result.mesh.triangles;
  CHECK(volume(made) == Approx(volume_world).epsilon(1e-3));
  return result;
}

}  // namespace

TEST_CASE("joined solids: bars that cross are joined beside a hollow box, which keeps its hollow", "[run]") {
  const RunResult result = check_united(together(crossing_bars(), hollow_box({8, 0, 0}, 3, .8)), 32 + 27 - 2.744, 3, 0);
  CHECK(united(result)["inner_surfaces"] == 1);
}

TEST_CASE("joined solids: bars one of which is hollow are joined where the other does not reach the hollow", "[run]") {
  const TriangleSoup hollow = shapes::inside_out(box({4.6, 2.4, .4}, {5.6, 3.6, 1.6}));
  check_united(together(crossing_bars(), hollow), 32 - 1.44, 2, 0);
}

TEST_CASE("joined solids: a bar that passes through a hollow leaves a ring of it", "[run]") {
  check_united(together(crossing_bars(), shapes::inside_out(box({1, 2.2, .2}, {5, 3.8, 1.8}))), 24 - 10.24 + 12 - .8, 2,
               1);
}

TEST_CASE("joined solids: a hollow that another part fills is solid", "[run]") {
  const TriangleSoup hollow = shapes::inside_out(box({2.5, 2.5, .8}, {3.5, 3.5, 1.2}));
  const RunResult result = check_united(together(crossing_bars(), hollow), 32, 1, 0);
  CHECK(united(result)["swallowed_components"] == 1);
}

TEST_CASE("joined solids: parts that look inward are turned, and joined as those that look outward", "[run]") {
  const RunResult outward = check_united(crossing_bars(), 32, 1, 0);
  const RunResult inward = check_united(shapes::inside_out(crossing_bars()), 32, 1, 0);
  CHECK(united(inward)["turned_components"] == 2);
  CHECK(inward.mesh.vertices.size() == outward.mesh.vertices.size());
  CHECK(inward.mesh.triangles == outward.mesh.triangles);
}

TEST_CASE("joined solids: a part that crosses itself is joined with another one", "[run]") {
  const RunResult result = result_of(together(overlapping_bars(), box({3, -1, 1.2}, {4, 5, 1.6})));
  CHECK(united(result)["not_joined"].is_null());
  CHECK(result.record.report.features.kept);
  CHECK(result.record.topology->is_closed_manifold());
  CHECK(result.record.topology->components == 1);
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
