// How far a run is: one fraction that begins at 0, never goes back, and ends at 1.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "isoshell/run/mesh_info.h"
#include "isoshell/run/run.h"
#include "isoshell/run/sequence.h"
#include "isoshell/run/steps.h"
#include "progress/progress_meter.h"
#include "run/small_run.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

/// All that was told, by a clock that the test moves.
struct Told {
  double now = 0;
  std::vector<Progress> all;
  ProgressMeter meter{[this](const Progress& p) { all.push_back(p); }, [this] { return now; }};

  void pass(double seconds, int ticks = 1) {
    for (int i = 0; i < ticks; ++i) {
      now += seconds / ticks;
      meter.tick();
    }
  }
  double fraction() const { return all.back().fraction; }
  double seconds_left() const { return all.back().seconds_left; }
};

void check_progress(const std::vector<Progress>& told) {
  REQUIRE(told.size() > 1);
  CHECK(told.front().fraction == 0);
  CHECK(told.back().fraction == 1);
  CHECK(told.back().seconds_left == 0);
  for (size_t i = 0; i < told.size(); ++i) {
    CHECK((told[i].stage_fraction >= 0 && told[i].stage_fraction <= 1));
    CHECK(told[i].seconds_left >= 0);
    if (i == 0) continue;
    CHECK(told[i].fraction >= told[i - 1].fraction);
    if (std::string(told[i].stage) == told[i - 1].stage && told[i - 1].stage_fraction < 1)
      CHECK(told[i].stage_fraction >= told[i - 1].stage_fraction);
  }
}

/// In their order, each once for as long as it goes on.
std::vector<std::string> stages_of(const std::vector<Progress>& told) {
  std::vector<std::string> stages;
  for (const Progress& p : told)
    if (stages.empty() || stages.back() != p.stage) stages.push_back(p.stage);
  return stages;
}

}  // namespace

TEST_CASE("progress: a run that takes what was expected is told so all the way", "[run]") {
  Told told;
  told.meter.expect({{"read", "", 2}, {"relax", "", 6}, {"write", "", 2}});
  told.meter.begin("read");
  CHECK(told.seconds_left() == Approx(10));
  told.pass(2, 20);
  told.meter.end("read");
  CHECK(told.fraction() == Approx(.2).margin(.01));
  CHECK(told.seconds_left() == Approx(8).margin(.1));
  told.meter.begin("relax");
  for (int i = 1; i <= 60; ++i) {
    told.pass(.1);
    told.meter.hear("relax", i / 60.);
  }
  told.meter.end("relax");
  CHECK(told.fraction() == Approx(.8).margin(.01));
  told.meter.begin("write");
  told.pass(2, 20);
  told.meter.end("write");
  told.meter.finish();
  check_progress(told.all);
}

TEST_CASE("progress: rounds and stages that nobody expected slow it down, and never take it back", "[run]") {
  Told told;
  told.meter.expect({{"prepare", "sheet", 3}, {"triangulate", "post", 3}, {"write", "", 1}});
  told.meter.begin("prepare");
  for (int round = 0; round < 5; ++round)
    for (const char* stage : {"sheet", "features"}) {
      const double before = told.fraction();
      told.meter.hear(stage, 0);
      told.pass(3, 10);
      told.meter.hear(stage, 1);
      CHECK(told.fraction() > before);
    }
  told.meter.end("prepare");
  const double before = told.fraction();
  told.meter.expect({{"triangulate", "post", 300}, {"triangulate", "coarsen", 100}});
  told.meter.begin("triangulate");
  CHECK(told.fraction() == before);
  CHECK(told.seconds_left() > 300);
  told.meter.hear("post", 0);
  told.meter.hear("relax", .5);  // a stage within that one
  told.pass(900, 100);
  told.meter.hear("post", 1);
  told.meter.end("triangulate");
  told.meter.finish();
  check_progress(told.all);
}

TEST_CASE("progress: it goes on while one stage takes far longer than expected, and tells of a slow machine", "[run]") {
  Told told;
  told.meter.expect({{"read", "", 1}, {"prepare", "", 9}});
  told.meter.begin("read");
  for (int i = 0; i < 20; ++i) {
    const double before = told.fraction();
    told.pass(2);
    CHECK(told.fraction() > before);
  }
  told.meter.end("read");
  CHECK(told.seconds_left() > 9);
  CHECK(told.seconds_left() < 9 * 40 / 4);  // one stage alone does not say that all are so late
}

TEST_CASE("progress: nothing is told before a step has begun", "[run]") {
  Told told;
  told.meter.expect({{"read", "", 1}});
  told.pass(.5, 3);
  CHECK(told.all.empty());
  told.meter.begin("read");
  told.pass(.5, 3);
  CHECK(stages_of(told.all) == std::vector<std::string>{"read"});
}

TEST_CASE("progress: a whole run begins at 0 and ends at 1, its stages in their order", "[run]") {
  CpuContext context;
  RunRequest request = small_run();
  request.measures = Measures::all;
  Heard heard(request);
  run(input_of(ball(), "ball"), request, context);
  check_progress(heard.progress);
  CHECK(stages_of(heard.progress) ==
        std::vector<std::string>{"prepare", "risks", "relax", "triangulate", "measure", "distance"});
  CHECK_FALSE(context.progress);

  heard.progress.clear();
  RunSteps steps(request);
  steps.read(context, [] { return input_of(ball(), "ball"); });
  steps.prepare(context);
  steps.relax(context);
  steps.finish(context);
  check_progress(heard.progress);
  CHECK(stages_of(heard.progress).front() == "read");
}

TEST_CASE("progress: a certificate has it, too", "[run]") {
  CpuContext context;
  std::vector<Progress> told;
  const auto read = [] { return input_of(ball(), "ball"); };
  mesh_info(read, read, {}, context, [&](const Progress& p) { told.push_back(p); });
  check_progress(told);
  CHECK(stages_of(told) == std::vector<std::string>{"read", "census", "distance"});
}

TEST_CASE("progress: that of a sequence is of all its frames", "[run]") {
  SequenceProgress sequence(4);
  sequence.go_to(0);  // is there
  CHECK(std::isfinite(sequence.of({"read", 0, 0, 0}).seconds_left));
  sequence.go_to(1);
  sequence.begin();
  CHECK(sequence.of({"relax", .5, .2, 3}).fraction == .375);
  CHECK(sequence.of({"relax", .5, .2, 3}).seconds_left >= 9);
  sequence.go_to(3);
  sequence.begin();
  CHECK(sequence.of({"write", 1, 1, 0}).fraction == 1);
  CHECK(sequence.of({"write", 1, 1, 0}).seconds_left == 0);
  CHECK(SequenceProgress(0).of({"relax", .5, .2, 3}).fraction == .5);
}
