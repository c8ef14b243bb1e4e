// A run step by step.
#include <filesystem>

#include "isoshell/advanced/digest.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/run/steps.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/temporary_file.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

RunRequest small_request() {
  RunRequest request;
  request.options.values.vertices = 200;
  request.options.values.resolution = 40;
  request.options.values.features.creases = Features::Creases::off;
  return request;
}

Input ball() { return input_of(shapes::sphere({0, 0, 0}, 1, 32), "ball"); }

RunSteps steps_of_ball(const RunRequest& request, Context& context) {
  RunSteps steps(request);
  steps.take(ball(), context);
  return steps;
}

}  // namespace

TEST_CASE("steps: all of them make the mesh and the record of a run, and are done once", "[run]") {
  TestContext context;
  const RunResult whole = run(ball(), small_request(), context);
  RunSteps steps = steps_of_ball(small_request(), context);
  CHECK(steps.estimate(context).vertices == 200);
  const Prepared& prepared = steps.prepare(context);
  CHECK(&steps.prepare(context) == &prepared);
  CHECK(&steps.relax(context) == &steps.relax(context));
  const RunResult made = steps.finish(context);
  CHECK(digest(made.mesh) == digest(whole.mesh));
  REQUIRE(made.record.times.size() == whole.record.times.size());
  for (size_t i = 0; i < made.record.times.size(); ++i)
    CHECK(made.record.times[i].stage == whole.record.times[i].stage);
  CHECK(made.record.total_ms > 0);
}

TEST_CASE("steps: a run ends once, and its seeds stay where that is asked for", "[run]") {
  TestContext context;
  RunSteps kept = steps_of_ball(small_request(), context);
  kept.finish(context, true);
  CHECK(kept.relax(context).seeds.size() == 200);
  CHECK(contains(message_of(ErrorCode::usage, [&] { kept.finish(context); }), "the run is over"));
  RunSteps spent = steps_of_ball(small_request(), context);
  spent.finish(context);
  CHECK(contains(message_of(ErrorCode::usage, [&] { spent.relax(context); }), "the seeds went into the mesh"));
}

TEST_CASE("steps: stage files need the shell", "[run]") {
  TestContext context;
  const TemporaryFile shell("steps_shell.vdb");
  RunSteps without = steps_of_ball(small_request(), context);
  CHECK(contains(message_of(ErrorCode::usage, [&] { without.save_shell(shell.path, false, context); }), "want_shell"));
}

TEST_CASE("steps: a stage file is read as that of a run", "[run]") {
  if (!can_write_vdb()) return;
  TestContext context;
  const TemporaryFile voronoi("steps_voronoi.vdb"), preview("steps_voronoi.preview.vdb");
  RunRequest request = small_request();
  request.options.values.want_shell = true;
  RunSteps steps = steps_of_ball(request, context);
  steps.save_voronoi(voronoi.path, false, context);
  const RunResult made = steps.finish(context);
  RunRequest resumed;
  resumed.input.path = voronoi.path;
  CHECK(digest(run(resumed, context).mesh) == digest(made.mesh));
}
