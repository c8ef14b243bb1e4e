// A run on a surface with a vertex far away: all that it says is of the one without.
#include "isoshell/run/run.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

TriangleSoup ball_with_needle() {
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 32);
  ball.vertices[200] = {1e5, 0, 0};
  return ball;
}

RunRequest request_of(const RemeshOptions& options) {
  RunRequest request;
  request.options = requested_options(options);
  request.measures = Measures::all;
  return request;
}

}  // namespace

TEST_CASE("far vertices: a dry run estimates the grid that the run has", "[run]") {
  CpuContext context;
  RemeshOptions options;
  options.edge_length_world = .5;  // longer than the foot of the needle
  const RunEstimate estimate = dry_run(input_of(ball_with_needle(), "ball"), request_of(options), context);
  const RunResult made = run(input_of(ball_with_needle(), "ball"), request_of(options), context);
  CHECK(estimate.voxel_size_world == made.record.report.grid.frame.voxel_size);
  CHECK(estimate.vertices == made.record.vertices);
  CHECK(made.record.report.input.far.vertices == 1);
}

TEST_CASE("far vertices: distances are from the surface without them, of a solid and of regions", "[run]") {
  CpuContext context;
  for (const char* regions : {"", "components"}) {
    INFO(regions);
    RemeshOptions options;
    options.vertices = 600;
    options.regions = regions;
    const TriangleSoup two = shapes::together(ball_with_needle(), shapes::sphere({3, 0, 0}, 1, 32));
    const RunResult made = run(input_of(two, "balls"), request_of(options), context);
    REQUIRE(made.record.distance);
    CHECK(made.record.distance->from_reference.max < .2);
    CHECK(made.record.report.input.far.vertices == 1);
  }
}
