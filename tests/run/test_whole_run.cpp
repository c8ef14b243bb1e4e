// The run as one call: what comes back, what is told, which files are written, and the same bytes as the steps.
#include <nlohmann/json.hpp>
#include <set>

#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "isoshell/run/run.h"
#include "run/small_run.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;
using Json = nlohmann::json;

namespace {

std::set<std::string> keys(const Json& object) {
  std::set<std::string> names;
  for (const auto& item : object.items()) names.insert(item.key());
  return names;
}

std::string refusal(const RunRequest& request, ErrorCode code) {
  CpuContext context;
  return message_of(code, [&] { run(request, context); });
}

}  // namespace

TEST_CASE("whole run: from memory to memory it is what remesh gives, and writes nothing", "[run]") {
  CpuContext context;
  RunRequest request = small_run();
  const RunResult result = run(input_of(ball(), "ball"), request, context);
  CHECK(digest(result.mesh) == digest(remesh(ball(), request.options.values, context).mesh));
  CHECK(result.record.vertices == 300);
  CHECK(result.record.topology->is_closed_manifold());
  CHECK(result.record.quality->theta_min_deg > 30);
  CHECK_FALSE(result.record.distance);
  CHECK(result.record.report.digests.empty());
  CHECK(result.missed_gates.empty());
  CHECK(result.record.warnings.empty());
  CHECK(result.record.device.backend == "cpu");
}

TEST_CASE("whole run: statistics have the keys of schema 1, whether written or asked for", "[run]") {
  const TemporaryFolder folder;
  CpuContext context;
  RunRequest request = small_run();
  request.statistics = folder / "s.json";
  request.output = named_output(folder / "out.ply", "", StopAfter::mesh);
  const RunResult result = run(input_of(ball(), "ball"), request, context);
  const Json j = Json::parse(statistics_json(result.record));
  CHECK(j == Json::parse(get_file(folder / "s.json")));
  CHECK(keys(j) == std::set<std::string>{"schema",         "version", "options",    "input",        "output",
                                         "grid",           "counts",  "gaps",       "attributes",   "topology",
                                         "features",       "quality", "sizing",     "borders",      "distance",
                                         "normals",        "energy",  "timings_ms", "memory_bytes", "device",
                                         "device_details", "digests", "warnings",   "coherence",    "regions"});
  CHECK(j["regions"].is_null());
  CHECK(j["schema"] == 1);
  CHECK(keys(j["options"]) ==
        std::set<std::string>{"vertices",           "edge-length", "band",       "outer-only", "method",
                              "iterations",         "tolerance",   "step",       "seed",       "fit",
                              "uniform-area",       "features",    "boundary",   "regions",    "attributes",
                              "color-features",     "uv-seams",    "adaptivity", "gradation",  "sizing",
                              "region-edge-length", "snap"});
  CHECK(keys(j["grid"]) == std::set<std::string>{"resolution", "voxel_size", "band", "closing", "grown"});
  CHECK(j["input"]["path"] == "ball");
  CHECK(j["output"]["format"] == "ply");
  CHECK(j["distance"]["hausdorff"] > 0);
  CHECK(j["digests"]["mesh"] == digest_text(digest(result.mesh)));
  const RunRecord empty;
  const Json nothing = Json::parse(statistics_json(empty));
  CHECK(keys(nothing) == keys(j));
  CHECK(nothing["quality"].is_null());
  CHECK(nothing["counts"]["vertices"].is_null());
}

TEST_CASE("whole run: what is said goes to the caller as it happens, and stays in the record", "[run]") {
  CpuContext context;
  std::vector<std::string> steps;
  context.progress = [&](const char* stage, double fraction) {
    if (fraction == 1) steps.push_back(stage);
  };
  RunRequest request = small_run();
  request.gates = parse_gates("genus=1,max-deviation=1e-9");
  const Heard heard(request);
  TriangleSoup open = ball();
  open.triangles.erase(open.triangles.begin() + 500, open.triangles.begin() + 540);
  const RunResult result = run(input_of(open, "ball"), request, context);
  CHECK(heard.warnings == result.record.warnings);
  CHECK(contains(heard.warnings.at(0), "ball: "));
  CHECK(result.missed_gates.size() == 2);
  CHECK(std::count(steps.begin(), steps.end(), "prepare") == 1);
  CHECK(std::count(steps.begin(), steps.end(), "triangulate") == 1);
}

TEST_CASE("whole run: stage files resume to the same bytes, with what was asked for in them", "[run][vdb]") {
  if (!can_write_vdb()) return;
  const TemporaryFolder folder;
  CpuContext context;
  RunRequest first = small_run();
  first.options.values.seed = 7;
  first.save_shell = folder / "s.vdb";
  first.save_voronoi = folder / "v.vdb";
  std::vector<std::string> written;
  first.around_write = [&](const std::string& path, const std::function<void()>& write) {
    write();
    written.push_back(path);
  };
  const uint64_t expected = digest(run(input_of(ball(), "ball"), first, context).mesh);
  CHECK(written == std::vector<std::string>{first.save_shell, first.save_voronoi});
  for (const std::string& file : written) {
    RunRequest second;
    second.input = named_input(file);
    const RunResult resumed = run(second, context);
    CHECK(digest(resumed.mesh) == expected);
    CHECK(resumed.record.input.kind == InputKind::stage);
    second.options.values.closing_vox.reset();
    second.options.given = {"close-gaps"};
    CHECK(digest(run(second, context).mesh) == expected);
    RemeshOptions other;
    other.closing_vox = 2;
    second.options = requested_options(other);
    CHECK(contains(refusal(second, ErrorCode::usage), "--close-gaps is fixed by the "));
  }
  const RequestedOptions kept = parse_options_json(read_stage(first.save_voronoi).info.options_json);
  CHECK(kept.values.resolution == 48);
  CHECK(kept.values.seed == 7);
}

TEST_CASE("whole run: a stage file resumes with the JSON of the options that made it", "[run][vdb]") {
  if (!can_write_vdb()) return;
  const TemporaryFolder folder;
  CpuContext context;
  RunRequest first = small_run();
  first.options.values.max_passes = 9;
  first.save_shell = folder / "s.vdb";
  first.save_voronoi = folder / "v.vdb";
  const uint64_t expected = digest(run(input_of(ball(), "ball"), first, context).mesh);
  const std::string requested = options_json(first.options.values);
  for (const std::string& file : {first.save_shell, first.save_voronoi}) {
    RunRequest second;
    second.input = named_input(file);
    second.options = parse_options_json(requested);
    CHECK(digest(run(second, context).mesh) == expected);
    second.options = parse_options_json(R"({"outer-only": false, "resolution": 0, "voxel-size": 0})");
    CHECK(digest(run(second, context).mesh) == expected);
    second.options = parse_options_json(R"({"outer-only": true})");
    CHECK(contains(refusal(second, ErrorCode::usage), "it was not given; leave it out"));
    second.options = parse_options_json(R"({"resolution": 47})");
    CHECK(contains(refusal(second, ErrorCode::usage), "it was 48; leave it out"));
  }
  RunRequest open;
  open.input = named_input(first.save_voronoi);
  open.options =
      parse_options_json(R"({"vertices": 0, "iterations": 0, "tolerance": -1, "step": 0, "edge-length": 0})");
  CHECK(digest(run(open, context).mesh) == expected);
}

TEST_CASE("whole run: a volume is read with its grid and its value", "[run][vdb]") {
  if (!can_write_vdb()) return;
  const TemporaryFolder folder;
  CpuContext context;
  RunRequest stage = small_run();
  stage.stop_after = StopAfter::voronoi;
  stage.output = named_output(folder / "v.vdb", "", stage.stop_after);
  const RunResult stopped = run(input_of(ball(), "ball"), stage, context);
  CHECK(stopped.mesh.vertices.empty());
  CHECK(stopped.record.vertices == -1);
  InputRequest preview = named_input(folder / "v.preview.vdb:density");
  preview.iso = 0.5;
  const Input input = read_input(preview, 0);
  CHECK(input.facts.kind == InputKind::volume);
  CHECK(input.soup.triangles.size() > 1000);
}

TEST_CASE("whole run: files are looked at before any work, and requests before any file", "[run]") {
  const TemporaryFolder folder;
  RunRequest request = small_run();
  request.input = named_input(folder / "none.ply");
  put_file(folder / "there.ply", "precious");
  request.output = named_output(folder / "there.ply", "", StopAfter::mesh);
  CHECK(contains(refusal(request, ErrorCode::unwritable_output), "exists already"));
  request.statistics = folder / "there.ply";
  request.overwrite = true;
  CHECK(contains(refusal(request, ErrorCode::usage), "named twice"));
  request.statistics.clear();
  CHECK(contains(refusal(request, ErrorCode::unreadable_input), "no such file"));
  request.stop_after = StopAfter::shell;
  request.gates.closed = true;
  CHECK(contains(refusal(request, ErrorCode::usage), "--require needs a mesh"));
  CHECK_THROWS_AS(named_output("a.fbx", "", StopAfter::mesh), Error);
  CHECK_THROWS_AS(named_output("a.ply", "", StopAfter::shell), Error);
  CHECK(get_file(folder / "there.ply") == "precious");
}

TEST_CASE("whole run: an output that was filled in by hand is refused before any work, too", "[run]") {
  const TemporaryFolder folder;
  CpuContext context;
  RunRequest request = small_run();
  request.input = named_input(folder / "none.ply");
  request.output.path = folder / "x.dae";
  CHECK(contains(refusal(request, ErrorCode::usage), "ply, obj, stl, off"));
  request.output.path = "-";
  CHECK(contains(refusal(request, ErrorCode::usage), "--output-format"));
  request.output.path = folder / "x.ply";
  request.stop_after = StopAfter::shell;
  CHECK(contains(refusal(request, ErrorCode::usage), "OUTPUT is a .vdb file"));
  request.stop_after = StopAfter::mesh;
  request.output.format = ".OFF";
  CHECK(run(input_of(ball(), "ball"), request, context).record.output.format == "off");
  CHECK(get_file(folder / "x.ply").compare(0, 3, "OFF") == 0);
}

TEST_CASE("whole run: a build without OpenVDB refuses a sizing field before anything is read", "[run]") {
  if (can_write_vdb()) return;
  RunRequest request = small_run();
  request.input = named_input("none.ply");
  request.options.sizing = "f.vdb";
  CHECK(contains(refusal(request, ErrorCode::unreadable_input), "build with -DISOSHELL_VDB=ON"));
}

TEST_CASE("whole run: a level set that stays in memory needs no OpenVDB", "[run]") {
  CpuContext context;
  RunRequest request = small_run();
  request.stop_after = StopAfter::level_set;
  request.level_set.keep = true;
  const RunResult result = run(input_of(ball(), "ball"), request, context);
  REQUIRE(result.level_set);
  CHECK(result.level_set->voxels.voxel_count() > 0);
  if (can_write_vdb()) return;
  const TemporaryFolder folder;
  request.input = named_input("none.ply");
  request.output = named_output(folder / "out.vdb", "", request.stop_after);
  CHECK(contains(refusal(request, ErrorCode::unwritable_output), "this build writes no .vdb files"));
}

TEST_CASE("whole run: one that is cancelled says what was written", "[run]") {
  const TemporaryFolder folder;
  CpuContext context;
  context.cancel = true;
  RunRequest request = small_run();
  request.output = named_output(folder / "out.ply", "", StopAfter::mesh);
  CHECK(message_of(ErrorCode::interrupted, [&] { run(input_of(ball(), "ball"), request, context); }) ==
        "interrupted; nothing was written");
  CHECK(folder.file_count() == 0);
}

TEST_CASE("whole run: an estimate reads, and writes nothing", "[run]") {
  const TemporaryFolder folder;
  write_mesh(folder / "ball.ply", mesh_of(ball()));
  CpuContext context;
  RunRequest request = small_run();
  request.input = named_input(folder / "ball.ply");
  const RunEstimate estimate = dry_run(request, context);
  CHECK(estimate.resolution == 48);
  CHECK(estimate.vertices == 300);
  CHECK(folder.file_count() == 1);
}
