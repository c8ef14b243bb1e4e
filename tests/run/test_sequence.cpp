// Sequences: vertices keep their numbers, and the files do not depend on how the sequence was run.
#include <set>

#include "isoshell/advanced/digest.h"
#include "isoshell/mesh_topology.h"
#include "run/sequences.h"

using namespace isoshell;

TEST_CASE("sequence: vertices keep their numbers and most edges, and every frame is a mesh of its own", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 5, twisted);
  std::vector<TriangleMesh> meshes;
  request.after_frame = [&](int64_t, const RunResult& r) {
    meshes.push_back(r.mesh);
    CHECK(r.record.quality->theta_min_deg > 30);
    CHECK(check_mesh(r.mesh).is_closed_manifold());
    CHECK(r.record.report.optimize.self_intersections == 0);
    CHECK(r.mesh.vertices.size() == 600);
  };
  const SequenceResult result = run_sequence(request, context);
  CHECK(result.made == 5);
  CHECK(result.followed == 4);
  CHECK(result.warm == 4);
  CHECK(result.kept_edges_worst_pct > 97);
  CHECK(result.born < 12);
  // The oracle: where the twist takes a vertex.
  for (int f = 1; f < 5; ++f) {
    int far = 0;
    for (size_t v = 0; v < 600; ++v) {
      const WorldPoint p = meshes[size_t(f) - 1].vertices[v], q = meshes[size_t(f)].vertices[v];
      const double c = std::cos(0.06 * p.x), s = std::sin(0.06 * p.x);
      far += std::hypot(q.x - p.x, q.y - (c * p.y - s * p.z), q.z - (s * p.y + c * p.z)) > 0.2;  // edges are .4 long
    }
    CHECK(far < 30);
  }
}

TEST_CASE("sequence: resumed, or with other threads, it writes the same files", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  const SequenceRequest whole = frames_in(folder, 4, twisted);
  run_sequence(whole, context);
  SequenceRequest part = request_in(folder, 2, "again.##.ply");
  context.threads = 1;
  run_sequence(part, context);
  part.frames.last = 3;
  CHECK(contains(refusal(part, ErrorCode::unwritable_output), "again.00.ply"));
  part.resume = true;
  const SequenceResult rest = run_sequence(part, context);
  CHECK(rest.found == 2);
  CHECK(rest.made == 2);
  CHECK(rest.warm == 2);
  CHECK(files_of(part) == files_of(whole));
  part.frame.output = named_output(folder / "out.##.stl", "", StopAfter::mesh);
  CHECK(contains(refusal(part, ErrorCode::usage), "PLY"));
}

TEST_CASE("sequence: a chain of frames in memory makes the meshes that files make", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 3, twisted);
  std::vector<uint64_t> digests;
  request.after_frame = [&](int64_t, const RunResult& r) { digests.push_back(digest(r.mesh)); };
  run_sequence(request, context);
  RunRequest in_memory;
  in_memory.options = request.frame.options;
  FrameChain chain;
  for (int f = 0; f < 3; ++f) {
    const auto soup = [&] { return read_mesh(folder / ("in.0" + std::to_string(f) + ".ply")); };
    CHECK_THROWS_AS(chain.run(input_of(soup(), "frame"), request_of_frame(request, f), context), Error);  // they exist
    CHECK(digest(chain.run(input_of(soup(), "frame"), in_memory, context).mesh) == digests[size_t(f)]);
  }
}

TEST_CASE("sequence: a surface that stands still keeps every edge, and one whose faces change most of them",
          "[sequence]") {
  TestContext context;
  const TemporaryFolder still, other;
  write_frames(still, 4, [](int) { return twisted(0); });
  const SequenceResult same = run_sequence(request_in(still, 4, "out.##.ply"), context);
  CHECK(same.kept_edges_worst_pct > 98.5);
  CHECK(same.born <= 2);
  write_frames(other, 3, [](int f) { return shapes::torus(2 + 0.02 * f, 0.7, uint32_t(90 + 6 * f), 48); });
  const SequenceResult changing = run_sequence(request_in(other, 3, "out.##.ply"), context);
  CHECK(changing.warm == 2);
  CHECK(changing.kept_edges_worst_pct > 97);
}

TEST_CASE("sequence: parts that become one mesh on with the right topology", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 3, [](int f) {
    const double gap = 0.5 - 0.7 * f;
    return shapes::together(shapes::sphere({-2.0 - gap / 2, 0.1, 0}, 2, 40),
                            shapes::sphere({2.0 + gap / 2, 0, 0.1}, 2, 40));
  });
  request.frame.options.values.features = {Features::Creases::off, 0};
  std::vector<int64_t> components;
  request.after_frame = [&](int64_t, const RunResult& r) {
    CHECK(check_mesh(r.mesh).is_closed_manifold());
    CHECK(r.record.report.optimize.self_intersections == 0);
    components.push_back(r.record.topology->components);
  };
  run_sequence(request, context);
  CHECK(components == std::vector<int64_t>{2, 1, 1});
}

TEST_CASE("sequence: a crisp part that turns keeps its creases, and the vertices on them", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 4, [](int f) {
    return turned(shapes::box({0, 0, 0}, {3, 2, 1}), 0.1 * f);
  });
  request.frame.statistics = folder / "s.##.json";
  std::vector<RunResult> made;
  request.after_frame = [&](int64_t, const RunResult& r) { made.push_back(r); };
  const SequenceResult result = run_sequence(request, context);
  CHECK(result.warm == 3);
  CHECK(result.kept_edges_worst_pct > 99);
  CHECK(result.born <= 2);
  for (size_t f = 0; f < 4; ++f) {
    const FeatureReport& features = made[f].record.report.features;
    CHECK(features.kept_length_world == Approx(24));
    CHECK(check_mesh(made[f].mesh).is_closed_manifold());
    if (f == 0) continue;
    const auto edge_of = [](const MeshCurveEdge& e) { return e.vertex; };
    std::set<std::array<uint32_t, 2>> before, now;
    for (const MeshCurveEdge& e : made[f - 1].mesh.features.curve_edges) before.insert(edge_of(e));
    for (const MeshCurveEdge& e : made[f].mesh.features.curve_edges) now.insert(edge_of(e));
    CHECK(now == before);
  }
  CHECK(contains(get_file(folder / "s.01.json"), "\"began_warm\": true"));
  CHECK(contains(get_file(folder / "s.00.json"), "\"coherence\": null"));
}

TEST_CASE("sequence: a crisp part whose faces change keeps its creases and gets new ones, resumed or not",
          "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 4, [](int f) {
    TriangleSoup part = shapes::box({0, 0, 0}, {3, 2, 1});
    if (f == 3) part = shapes::together(part, shapes::box({0, 0, 1.5}, {1, 1, 2.5}));
    return turned(shapes::shuffled(part, uint64_t(f)), 0.01 * f);
  });
  std::vector<double> kept_length_world;
  request.after_frame = [&](int64_t, const RunResult& r) {
    kept_length_world.push_back(r.record.report.features.kept_length_world);
  };
  const SequenceResult result = run_sequence(request, context);
  CHECK(result.warm == 3);
  REQUIRE(kept_length_world.size() == 4);
  for (size_t f = 0; f < 4; ++f) CHECK(kept_length_world[f] == Approx(f < 3 ? 24 : 36).epsilon(0.001));
  SequenceRequest part = request_in(folder, 2, "again.##.ply");
  run_sequence(part, context);
  part.frames.last = 3;
  part.resume = true;
  run_sequence(part, context);
  CHECK(files_of(part) == files_of(request));
}

TEST_CASE("sequence: parts that come to touch along an edge keep their creases", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 2, [](int f) {
    const double gap = f == 0 ? 0.05 : 0;
    return shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}),
                            shapes::box({1 + gap, 1 + gap, 0}, {2 + gap, 2 + gap, 1}));
  });
  std::vector<RunResult> made;
  request.after_frame = [&](int64_t, const RunResult& r) { made.push_back(r); };
  run_sequence(request, context);
  REQUIRE(made.size() == 2);
  for (const RunResult& r : made) {
    CHECK(r.record.report.features.kept_length_world == Approx(24).epsilon(0.001));
    CHECK(check_mesh(r.mesh).is_closed_manifold());
  }
}

TEST_CASE("sequence: frames with creases are the same with other threads, and resumed", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  const SequenceRequest whole = frames_in(folder, 3, [](int f) {
    return turned(shapes::box({0, 0, 0}, {3, 2, 1}), 0.1 * f);
  });
  run_sequence(whole, context);
  context.threads = 1;
  SequenceRequest part = request_in(folder, 2, "again.##.ply");
  run_sequence(part, context);
  part.frames.last = 2;
  part.resume = true;
  CHECK(run_sequence(part, context).warm == 1);
  CHECK(files_of(part) == files_of(whole));
}

TEST_CASE("sequence: a frame of another shape begins cold", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 2, [](int f) {
    return f == 0 ? twisted(0) : shapes::box({0, 0, 0}, {3, 2, 1});
  });
  std::string why_cold;
  request.after_frame = [&](int64_t, const RunResult& r) { why_cold = r.record.report.coherence.why_cold; };
  CHECK(run_sequence(request, context).warm == 0);
  CHECK(contains(why_cold, "do not lie on this one as they did"));
}

TEST_CASE("sequence: without coherence every frame is a run of its own", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 2, twisted);
  request.is_coherent = false;
  CHECK(run_sequence(request, context).followed == 0);
  const TriangleMesh alone = remesh(read_mesh(folder / "in.01.ply"), request.frame.options.values, context).mesh;
  const TriangleSoup made = read_mesh(folder / "out.01.ply");
  CHECK(made.triangles == alone.triangles);
}

TEST_CASE("sequence: missing frames are named before anything starts", "[sequence]") {
  const TemporaryFolder folder;
  const SequenceRequest request = frames_in(folder, 4, twisted);
  std::filesystem::remove(folder / "in.02.ply");
  CHECK(contains(refusal(request, ErrorCode::unreadable_input), "frame 2, "));
  CHECK_FALSE(std::filesystem::exists(folder / "out.00.ply"));
}

TEST_CASE("sequence: a bad frame stops it by name, or is left out", "[sequence]") {
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 4, twisted);
  put_file(folder / "in.01.ply", "ply\nnonsense\n");
  CHECK(contains(refusal(request, ErrorCode::unreadable_input), "frame 1: "));
  CHECK(std::filesystem::exists(folder / "out.00.ply"));
  CHECK_FALSE(std::filesystem::exists(folder / "out.02.ply"));
  request.keep_going = request.frame.overwrite = true;
  TestContext context;
  const SequenceResult result = run_sequence(request, context);
  REQUIRE(result.bad.size() == 1);
  CHECK(result.bad[0].frame == 1);
  CHECK(result.bad[0].code == ErrorCode::unreadable_input);
  CHECK(result.made == 3);
  CHECK(result.warm == 2);
}

TEST_CASE("sequence: gates hold for every frame, and those of coherence for frames that follow", "[sequence]") {
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 2, [](int f) { return twisted(8 * f); });
  request.frame.gates = parse_gates("closed,kept-edges=100,born=0");
  CHECK(contains(refusal(request, ErrorCode::gate_failed), "frame 1: gate failed: kept-edges=100"));
  CHECK(std::filesystem::exists(folder / "out.01.ply"));
}

TEST_CASE("sequence: what has no place for a number, or no file, is refused", "[sequence]") {
  const TemporaryFolder folder;
  write_frames(folder, 2, twisted);
  SequenceRequest request = request_in(folder, 2, "out.ply");
  CHECK(contains(refusal(request, ErrorCode::usage), "no place for the number"));
  request = request_in(folder, 2, "out.##.ply");
  request.frame.report = folder / "r.html";
  CHECK(contains(refusal(request, ErrorCode::usage), "--report"));
  request = request_in(folder, 2, "out.##.ply");
  request.frame.options.values.method = Method::shell;
  CHECK(contains(refusal(request, ErrorCode::usage), "method sheet"));
}
