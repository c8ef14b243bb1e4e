// What a sequence takes for its own when it resumes, what it says when it ends early, and which outputs it refuses.
#include "io/leftovers.h"
#include "run/sequences.h"
#include "run/small_run.h"

using namespace isoshell;

TEST_CASE("sequence: resumed, it makes again what is not whole or not of this run, says so, and keeps the rest",
          "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 4, twisted);
  request.frame.options.values.vertices = 200;
  request.frame.statistics = folder / "s.##.json";
  Heard heard(request.frame);
  run_sequence(request, context);
  const std::vector<std::string> whole = files_of(request);
  request.resume = true;
  const auto resumed = [&](const std::string& frame, const std::string& why, int64_t made) {
    INFO(frame << ": " << why);
    heard.warnings.clear();
    const SequenceResult result = run_sequence(request, context);
    CHECK(result.made == made);
    CHECK(result.found == 4 - made);
    CHECK(heard.warnings.size() == size_t(made));
    if (made > 0) CHECK(contains(heard.warnings.at(0), "out." + frame + ".ply " + why));
    return files_of(request) == whole;
  };
  CHECK(resumed("", "", 0));
  put_file(folder / "out.01.ply", "");
  CHECK(resumed("01", "cannot be read", 1));
  put_file(folder / "out.02.ply", whole[2].substr(0, whole[2].size() - 100));
  CHECK(resumed("02", "cannot be read", 1));
  put_file(folder / "out.03.ply", whole[3].substr(0, whole[3].size() - 12) + std::string(12, '\0'));
  CHECK(resumed("03", "has faces that are none", 1));
  write_mesh(folder / "out.00.ply", mesh_of(twisted(0)), {"", true});
  CHECK(resumed("00", "does not say that a sequence made it", 1));
  std::filesystem::remove(folder / "s.02.json");
  CHECK(resumed("02", "is there without " + (folder / "s.02.json"), 1));
  put_file(folder / "out.01.ply", whole[2]);
  CHECK(resumed("01", "was made of another input", 1));
  request.frame.options.values.vertices = 150;
  CHECK_FALSE(resumed("00", "was made with other options", 4));
  request.frame.options.values.vertices = 200;
  CHECK(resumed("00", "was made with other options", 4));
  write_mesh(folder / "in.02.ply", mesh_of(twisted(3)), {"", true});
  CHECK_FALSE(resumed("02", "was made of another input", 2));
  CHECK(contains(heard.warnings.at(1), "out.03.ply follows another frame"));
}

TEST_CASE("sequence: an interruption names the frames that were written", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 4, twisted);
  request.after_frame = [&](int64_t frame, const RunResult&) { context.cancel = frame == 2; };
  const std::string said = refusal_in(request, ErrorCode::interrupted, context);
  CHECK(contains(said, "written before: " + (folder / "out.00.ply") + " to " + (folder / "out.02.ply") + ", 3 frames"));
}

TEST_CASE("sequence: outputs that are one file, or another frame's input, are refused before any frame", "[sequence]") {
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 2, twisted);
  std::filesystem::create_symlink("in.01.ply", folder / "out.00.ply");
  request.frame.overwrite = true;
  CHECK(contains(refusal(request, ErrorCode::usage), "are one file"));
  std::filesystem::remove(folder / "out.00.ply");
  std::filesystem::create_symlink("gone", folder / "out.01.ply");
  CHECK(contains(refusal(request, ErrorCode::unwritable_output), "which is not there"));
  CHECK_FALSE(std::filesystem::exists(folder / "out.00.ply"));
}

TEST_CASE("sequence: edge lengths of an attribute hold in every frame, and another attribute's make it anew",
          "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  for (int f = 0; f < 2; ++f) {
    TriangleMesh mesh = mesh_of(twisted(f));
    for (const auto& [name, length] : {std::pair{"coarse", .5}, std::pair{"fine", .4}})
      mesh.attributes.push_back(
          {name, NumberType::f64, 1, std::vector<double>(mesh.vertices.size(), length), AttributeDomain::vertex});
    write_mesh(path_of_frame(folder / "in.##.ply", f), mesh);
  }
  SequenceRequest request = request_in(folder, 2, "out.##.ply");
  RemeshOptions options;
  request.frame.options = requested_options(options, "coarse");
  CHECK(run_sequence(request, context).made == 2);
  const std::vector<std::string> coarse = files_of(request);
  request.resume = true;
  CHECK(run_sequence(request, context).found == 2);
  request.frame.options.sizing = "fine";
  CHECK(run_sequence(request, context).made == 2);
  CHECK(files_of(request) != coarse);
}

TEST_CASE("sequence: resumed with another offset, or of a mesh with other images, it makes frames again",
          "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  const auto write_input = [&](const std::string& image) {
    TriangleMesh mesh = mesh_of(twisted(0));
    mesh.files.textures = {image};
    mesh.attributes.push_back(
        {kUvName, NumberType::f32, 2, std::vector<double>(6 * mesh.triangles.size(), .5), AttributeDomain::corner});
    write_mesh(folder / "in.00.ply", mesh, {"", true});
  };
  write_input("one.png");
  SequenceRequest request = request_in(folder, 1, "out.##.ply");
  request.frame.output.recenter = {true, WorldPoint{0, 0, 0}};
  request.resume = true;
  CHECK(run_sequence(request, context).made == 1);
  CHECK(run_sequence(request, context).found == 1);
  request.frame.output.recenter.offset_world = WorldPoint{10, 0, 0};
  CHECK(run_sequence(request, context).made == 1);
  CHECK(run_sequence(request, context).found == 1);
  write_input("two.png");
  CHECK(run_sequence(request, context).made == 1);
  CHECK(contains(get_file(folder / "out.00.ply"), "two.png"));
}

TEST_CASE("sequence: what killed processes have left goes before the first frame, and no frame looks for it again",
          "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 3, twisted);
  const std::string ended = std::to_string(ended_process());
  const std::string before = temporary_of(ended), during = temporary_of(ended);
  put_file(folder / before, "part");
  request.after_frame = [&](int64_t frame, const RunResult&) {
    CHECK_FALSE(std::filesystem::exists(folder / before));
    if (frame == 0) put_file(folder / during, "part");
  };
  run_sequence(request, context);
  CHECK(std::filesystem::exists(folder / during));
}

TEST_CASE("sequence: a frame that there is no memory to read is not taken for a damaged one", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  SequenceRequest request = frames_in(folder, 1, twisted);
  run_sequence(request, context);
  const RunRequest one = request_of_frame(request, 0);
  const Input input = read_input_of(one, context, {});
  CHECK(FrameChain().go_on_from(input, one, context).empty());
  context.memory_limit_bytes = 4096;  // enough for the header
  CHECK(contains(message_of(ErrorCode::out_of_memory, [&] { FrameChain().go_on_from(input, one, context); }),
                 "--max-memory"));
}

TEST_CASE("sequence: of a frame that does not fit, only the header is read", "[sequence]") {
  const TemporaryFolder folder;
  MeshWriteOptions options;
  options.made_of = "one two three";
  write_mesh(folder / "a.ply", mesh_of(twisted(0)), options);
  const std::string whole = get_file(folder / "a.ply");
  CHECK(made_of_in_ply(folder / "a.ply", 4096) == "one two three");
  put_file(folder / "a.ply", whole.substr(0, whole.find("end_header") + 11));
  CHECK(made_of_in_ply(folder / "a.ply") == "one two three");
  put_file(folder / "a.ply", whole.substr(0, whole.find("end_header")));
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { made_of_in_ply(folder / "a.ply"); }), "end_header"));
  put_file(folder / "a.ply", std::string(1 << 20, 'a'));
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { made_of_in_ply(folder / "a.ply"); }), "with ply"));
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { made_of_in_ply(folder / "no.ply"); }), "opened"));
}

TEST_CASE("sequence: only a mesh that may become a PLY file has the key of its frame", "[sequence]") {
  TestContext context;
  const TemporaryFolder folder;
  RunRequest request = request_of_frame(frames_in(folder, 1, twisted), 0);
  const auto has_key = [&](const std::string& output) {
    request.output = named_output(output.empty() ? "" : folder / output, "", StopAfter::mesh);
    return !FrameChain().run(read_input_of(request, context, {}), request, context).made_of.empty();
  };
  CHECK(has_key("a.ply"));
  CHECK(has_key(""));
  CHECK_FALSE(has_key("a.obj"));
}
