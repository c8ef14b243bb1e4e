// What the numbers of a file make of a result: measures, gates and statistics are of what readers get.
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "isoshell/mesh_census.h"
#include "isoshell/run/mesh_info.h"
#include "isoshell/run/sequence.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;
using Json = nlohmann::json;

namespace {

constexpr WorldPoint kNear{0, 0, 0}, kUtm{5e5, 5.4e6, 300}, kFar{1e8, 0, 0};
const char* const kGates = "closed,manifold,no-self-intersections,genus=1,components=1,count";

TriangleSoup torus_at(const WorldPoint& at) {
  TriangleSoup soup = shapes::torus(1, 0.4, 96, 48);
  for (WorldPoint& p : soup.vertices) p = {p.x + at.x, p.y + at.y, p.z + at.z};
  return soup;
}

RunRequest run_to(const std::string& path, const char* recenter = nullptr) {
  RemeshOptions options;
  options.vertices = 3000;
  RunRequest request;
  request.options = requested_options(options);
  request.output = named_output(path, "", StopAfter::mesh);
  if (recenter) request.output.recenter = parse_recenter(recenter);
  request.gates = parse_gates(kGates);
  return request;
}

/// Readers of a file ask the same of it.
std::vector<std::string> missed_by_reader(const std::string& path, const std::string& gates, Context& context) {
  MeshInfoRequest request;
  request.mesh.path = path;
  request.gates = parse_gates(gates);
  return mesh_info(request, context).missed_gates;
}

std::string all_of(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) all += text + "\n";
  return all;
}

}  // namespace

TEST_CASE("written positions: in every format the file has what the run says of it, near and far", "[run]") {
  const TemporaryFolder folder;
  CpuContext context;
  for (const WorldPoint& at : {kNear, kUtm, kFar})
    for (const FileFormat& format : file_formats()) {
      if (!format.writes_mesh) continue;
      const std::string path = folder / (std::to_string(int64_t(at.x)) + "." + format.name);
      INFO(path);
      const RunResult result = run(input_of(torus_at(at), "torus"), run_to(path), context);
      const TriangleSoup read = read_mesh(path);
      const MeshCensus census = take_census({read.vertices, read.triangles}, context, read.dirt.degenerate_faces);
      CHECK(census.intersecting_pairs == result.record.report.optimize.self_intersections);
      CHECK(census.shapes.angle_min_deg == Approx(result.record.quality->theta_min_deg).margin(1e-6));
      const bool is_good = missed_by_reader(path, "closed,manifold,no-self-intersections", context).empty();
      CHECK(is_good == result.missed_gates.empty());
      CHECK(is_good == (format.name != "stl" || at.x == 0));
      if (is_good) continue;
      CHECK(contains(all_of(result.missed_gates), path + ": its numbers are too coarse for "));
      CHECK(contains(all_of(result.record.warnings), "--recenter auto subtracts "));
    }
}

TEST_CASE("written positions: less an offset, which the file, a warning and the statistics name", "[run]") {
  const TemporaryFolder folder;
  CpuContext context;
  const RunResult in_memory = run(input_of(torus_at(kUtm), "torus"), run_to(""), context);
  for (const char* ending : {"stl", "ply", "obj", "off", "glb", "gltf"}) {
    const std::string path = folder / (std::string("out.") + ending);
    INFO(path);
    const RunResult result = run(input_of(torus_at(kUtm), "torus"), run_to(path, "auto"), context);
    CHECK(result.missed_gates.empty());
    CHECK(missed_by_reader(path, "closed,manifold,no-self-intersections,genus=1", context).empty());
    CHECK(contains(all_of(result.record.warnings), path + ": 500000 5400000 300 is subtracted from the positions"));
    CHECK(Json::parse(statistics_json(result.record))["output"]["offset"] == Json{500000, 5400000, 300});
    CHECK(contains(get_file(path), std::string(ending).substr(0, 2) == "gl" ? "\"offset\":[500000.0,5400000.0,300.0]"
                                                                            : "offset 500000 5400000 300"));
    for (const WorldPoint& p : read_mesh(path).vertices) CHECK(std::abs(p.x) + std::abs(p.y) + std::abs(p.z) < 5);
    REQUIRE(result.mesh.vertices.size() == in_memory.mesh.vertices.size());
    CHECK(same_bits(result.mesh.vertices[7], in_memory.mesh.vertices[7]));
  }
}

TEST_CASE("written positions: an offset that takes digits from 64-bit numbers is said to move vertices", "[run]") {
  const TemporaryFolder folder;
  CpuContext context;
  for (const char* ending : {"ply", "obj", "off"}) {
    const std::string path = folder / (std::string("out.") + ending);
    INFO(path);
    const RunResult near = run(input_of(torus_at(kUtm), "torus"), run_to(path, "auto"), context);
    const HeldPositions& exact = near.record.files.front().held;
    CHECK((exact.is_single || exact.moved_world == 0));
    RunRequest request = run_to(path, "1e13,0,0");
    request.overwrite = true;
    const RunResult result = run(input_of(torus_at(kNear), "torus"), request, context);
    const HeldPositions& held = result.record.files.front().held;
    const TriangleSoup read = read_mesh(path);
    double moved = 0;
    if (read.vertices.size() == result.mesh.vertices.size())
      for (size_t v = 0; v < read.vertices.size(); ++v)  // exact in sums of 64 + 64 bits, whose halves do not overlap
        moved = std::max(moved, std::abs((read.vertices[v].x + 1e13) - result.mesh.vertices[v].x));
    CHECK(held.moved_world == moved);
    CHECK(moved > 1e-4);
    CHECK(moved <= std::ldexp(1, -10));
  }
}

TEST_CASE("written positions: the way out of coarse 64-bit numbers is another offset", "[run]") {
  HeldPositions held;
  held.offset_world = {1e15, 0, 0};
  held.moved_world = held.shortest_edge_world = .1;
  const auto said = [&](const WorldPoint& to_origin) {
    return all_of(warnings_of_files({{"out.ply", "ply", held}}, to_origin));
  };
  CHECK(contains(said({0, 0, 0}), "ply files have 64-bit floats, which move vertices by up to 0.1"));
  CHECK(contains(said({0, 0, 0}), ": leave out --recenter\n"));
  CHECK(contains(said({5e5, 0, 0}), ": --recenter auto subtracts 500000 0 0 from them\n"));
}

TEST_CASE("written positions: the numbers that were measured are those that are written", "[mesh_file]") {
  const TemporaryFolder folder;
  const TriangleSoup torus = torus_at(kUtm);
  const TriangleMesh mesh{torus.vertices, torus.triangles};
  for (const char* ending : {"ply", "obj", "stl", "off", "glb", "gltf"}) {
    INFO(ending);
    MeshWriteOptions options;
    options.offset_world = {5e5, 5.4e6, 300};
    const std::string found = folder / (std::string("found.") + ending),
                      passed = folder / (std::string("passed.") + ending);
    write_mesh(found, mesh, options);
    options.held = positions_in_file(mesh, ending, options.offset_world).held;
    options.offset_world = {};
    write_mesh(passed, mesh, options);
    CHECK(get_file(passed) == get_file(found));
    options.held->lost_triangles = 3;
    options.overwrite = true;
    CHECK(
        contains(message_of(ErrorCode::unwritable_output, [&] { write_mesh(passed, mesh, options); }), "3 triangles"));
  }
}

TEST_CASE("written positions: distances are measured where the input is", "[run]") {
  const TemporaryFolder folder;
  CpuContext context;
  RunRequest request = run_to(folder / "out.stl", "500000,5400000,300");
  request.gates = parse_gates("max-deviation=0.05");
  CHECK(run(input_of(torus_at(kUtm), "torus"), request, context).missed_gates.empty());
}

TEST_CASE("written positions: what is no offset is refused, and one without a mesh", "[run]") {
  for (const char* text : {"", "1,2", "1,2,3,4", "a,b,c", "1,2,inf"})
    CHECK_FALSE(message_of(ErrorCode::usage, [&] { parse_recenter(text); }).empty());
  RunRequest request;
  request.output = named_output("out.vdb", "", StopAfter::shell);
  request.output.recenter = parse_recenter("auto");
  request.stop_after = StopAfter::shell;
  CHECK(contains(message_of(ErrorCode::usage, [&] { check_request(request); }), "--recenter is for files of meshes"));
}

TEST_CASE("written positions: frames with an offset are the same when resumed", "[run][sequence]") {
  const TemporaryFolder folder;
  CpuContext context;
  SequenceRequest sequence;
  for (int f = 0; f < 3; ++f)
    write_mesh(path_of_frame(folder / "in.##.ply", f), mesh_of(torus_at({kUtm.x + 0.02 * f, kUtm.y, kUtm.z})));
  sequence.frame = run_to(folder / "out.##.ply", "500000,5400000,300");
  sequence.frame.input.path = folder / "in.##.ply";
  sequence.frame.options.values.vertices = 500;
  sequence.frames = parse_frames("0-2");
  run_sequence(sequence, context);
  const std::string last = get_file(folder / "out.02.ply");
  std::filesystem::remove(folder / "out.02.ply");
  sequence.resume = true;
  run_sequence(sequence, context);
  CHECK(get_file(folder / "out.02.ply") == last);
  sequence.frame.output.recenter = parse_recenter("auto");
  CHECK(contains(message_of(ErrorCode::usage, [&] { check_sequence(sequence); }), "give one for all of them"));
}

TEST_CASE("written positions: a file is refused whose numbers do not hold the triangles", "[run][mesh_file]") {
  const TemporaryFolder folder;
  const auto refused = [&](const TriangleSoup& soup, const char* name) {
    return message_of(ErrorCode::unwritable_output, [&] { write_mesh(folder / name, mesh_of(soup)); });
  };
  CHECK(contains(refused(torus_at(kFar), "far.stl"), "lose their area; subtract an offset"));
  CHECK(contains(refused(shapes::box({0, 0, 0}, {1e-60, 1e-60, 1e-60}), "tiny.glb"), "lose their area"));
  CHECK_FALSE(std::filesystem::exists(folder / "far.stl"));
  for (const double side : {1e-200, 1e-60, 1e60, 1e200}) {
    INFO(side);
    const TriangleSoup box = shapes::box({0, 0, 0}, {side, side, side});
    write_mesh(folder / "box.ply", mesh_of(box), {"", true});
    CHECK(read_mesh(folder / "box.ply").vertices[7].x == box.vertices[7].x);
  }
  CHECK(contains(message_of(ErrorCode::unwritable_output,
                            [&] {
                              const TriangleSoup box = shapes::box({0, 0, 0}, {1e60, 1, 1});
                              positions_in_file(mesh_of(box), "stl");
                            }),
                 "would be infinite"));
}

TEST_CASE("written positions: the offset is round, and nothing is taken from what is near", "[mesh_file]") {
  const auto offset_of = [](const TriangleSoup& soup) { return offset_to_origin(mesh_of(soup)); };
  CHECK(same_bits(offset_of(torus_at({441906.3, 6329781.2, 12})), {441910, 6329780, 10}));
  CHECK(same_bits(offset_of(torus_at({3, -3, 0.5})), {0, 0, 0}));
  CHECK(same_bits(offset_to_origin({}), {0, 0, 0}));
}
