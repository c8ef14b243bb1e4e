// Runs whose vertices get values of grids: attributes, what is said of them, and files.
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "isoshell/error.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/openvdb.h"
#include "isoshell/run/sequence.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/test_context.h"

using namespace isoshell;
using Names = std::vector<std::string>;

namespace {

/// Linear in the place, so that what is between voxels is exact.
openvdb::Vec3f velocity_at(const openvdb::Vec3d& p) { return openvdb::Vec3f(openvdb::Vec3d(p.y(), -p.x(), 2 * p.z())); }
openvdb::Vec3f color_at(const openvdb::Vec3d& p) { return openvdb::Vec3f(openvdb::Vec3d(0.5) + 0.1 * p); }
float heat_at(const openvdb::Vec3d& p) { return float(3 + p.x() - p.y()); }

/// Voxels of another size than those of the surface, all around it.
template <class Grid, class At>
typename Grid::Ptr cube_of(const std::string& name, At at, double middle = 0) {
  auto grid = Grid::create();
  grid->setName(name);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.4));
  grid->transform().postTranslate(openvdb::Vec3d(middle, 0, 0));
  auto voxels = grid->getAccessor();
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j)
      for (int k = -8; k <= 8; ++k) voxels.setValueOn({i, j, k}, at(grid->indexToWorld(openvdb::Coord(i, j, k))));
  return grid;
}

openvdb::GridPtrVec ball_with_values(double x = 0) {
  openvdb::initialize();
  auto ball = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(2.f, openvdb::Vec3f(float(x), 0, 0), 0.1f);
  ball->setName("surface");
  return {ball,
          cube_of<openvdb::Vec3SGrid>("v", velocity_at),
          cube_of<openvdb::Vec3SGrid>("Cd", color_at),
          cube_of<openvdb::FloatGrid>("heat of it", heat_at),
          cube_of<openvdb::Int32Grid>("side", [](const openvdb::Vec3d& p) { return p.x() > 0 ? 7 : -7; }),
          cube_of<openvdb::BoolGrid>("mask", [](const openvdb::Vec3d&) { return true; }),
          cube_of<openvdb::FloatGrid>("elsewhere", heat_at, 100)};
}

struct Ball {
  TemporaryFolder folder;
  Ball() { openvdb::io::File(folder / "ball.vdb").write(ball_with_values()); }

  RunRequest asks(const Names& grids) const {
    RemeshOptions options;
    options.vertices = 400;
    RunRequest request;
    request.options = requested_options(options);
    request.input = named_input(folder / "ball.vdb");
    request.input.grids = grids;
    return request;
  }
};

std::string refusal(const RunRequest& request) {
  TestContext context;
  return message_of(ErrorCode::usage, [&] { run(request, context); });
}

}  // namespace

TEST_CASE("grids: all of a volume's file are values of the result's vertices", "[grids][run]") {
  const Ball ball;
  RunRequest request = ball.asks({"all"});
  Names warnings;
  request.tell = [&](MessageKind kind, const std::string& text) {
    if (kind == MessageKind::warning) warnings.push_back(text);
  };
  TestContext context;
  const RunResult result = run(request, context);
  CHECK(names_of(result.mesh.attributes) == Names{"v.0", "v.1", "v.2", "color", "heat_of_it", "side", "elsewhere"});
  const std::vector<Attribute>& of = result.mesh.attributes;
  double worst = 0;
  int64_t wrong_sides = 0;
  for (size_t i = 0; i < result.mesh.vertices.size(); ++i) {
    const WorldPoint& p = result.mesh.vertices[i];
    const openvdb::Vec3d at(p.x, p.y, p.z);
    const openvdb::Vec3f v = velocity_at(at), c = color_at(at);
    for (int k = 0; k < 3; ++k) {
      worst = std::max(worst, std::abs(named(of, "v." + std::to_string(k)).values[i] - v[k]));
      worst = std::max(worst, std::abs(named(of, "color").values[3 * i + size_t(k)] - c[k]));
    }
    worst = std::max(worst, std::abs(named(of, "heat_of_it").values[i] - heat_at(at)));
    wrong_sides += std::abs(p.x - 0.2) > 0.01 && named(of, "side").values[i] != (p.x > 0.2 ? 7 : -7);
  }
  CHECK(worst < 1e-5);
  CHECK(wrong_sides == 0);
  CHECK(named(of, "side").type == NumberType::i32);
  const auto grids = nlohmann::json::parse(statistics_json(result.record))["attributes"]["grids"];
  REQUIRE(grids.size() == 5);
  CHECK(grids[1] == nlohmann::json({{"name", "Cd"}, {"attributes", {"color"}}, {"vertices_outside", 0}}));
  CHECK(grids[4]["vertices_outside"] == 400);
  REQUIRE(warnings.size() == 1);
  CHECK(contains(warnings[0], "grid elsewhere has no active voxel at any vertex"));
}

TEST_CASE("grids: files are the same for any number of threads, and hold what formats do", "[grids][run]") {
  const Ball ball;
  Names files;
  for (const int threads : {1, 4}) {
    RunRequest request = ball.asks({"v", "side"});
    request.output = named_output(ball.folder / (std::to_string(threads) + ".ply"), "", StopAfter::mesh);
    Context context;
    context.threads = threads;
    run(request, context);
    files.push_back(get_file(request.output.path));
  }
  CHECK(files[0] == files[1]);
  CHECK(contains(files[0], "property float v.2\nproperty int side\n"));
  RunRequest request = ball.asks({"v", "Cd"});
  request.output = named_output(ball.folder / "out.obj", "", StopAfter::mesh);
  TestContext context;
  const RunResult result = run(request, context);
  CHECK(names_of(result.mesh.attributes) == Names{"color"});
  REQUIRE(result.record.attributes.dropped.size() == 1);
  CHECK(result.record.attributes.dropped[0].name == "v");
}

TEST_CASE("grids: those of other files are values of any result, also of a mesh", "[grids][run]") {
  const Ball ball;
  const std::string file = ball.folder / "ball.vdb";
  TestContext context;
  const RunResult made = run(ball.asks({}), context);
  write_mesh(ball.folder / "ball.ply", made.mesh);
  RunRequest request = ball.asks({file + ":v", file + ":Cd"});
  request.input.path = ball.folder / "ball.ply";
  request.input.format = "ply";
  CHECK(names_of(run(request, context).mesh.attributes) == Names{"v.0", "v.1", "v.2", "color"});
  request.input.grids = {"v"};
  CHECK(contains(refusal(request), "ball.ply is no volume of a .vdb file; name a grid of a file"));
  CHECK(contains(refusal(ball.asks({"v", file + ":v"})), "two grids 'v'"));
  CHECK(contains(refusal(ball.asks({"w"})), "has no grid \"w\""));
  CHECK(contains(refusal(ball.asks({"w"})), "\"heat of it\" (Tree_float_5_4_3)"));
  RunRequest stops = ball.asks({"v"});
  stops.stop_after = StopAfter::shell;
  stops.output = named_output(ball.folder / "shell.vdb", "", StopAfter::shell);
  CHECK(contains(refusal(stops), "--grids needs a mesh"));
}

TEST_CASE("grids: those in memory give a result the values of their file", "[grids][run]") {
  const Ball ball;
  const openvdb::GridPtrVec grids = ball_with_values();
  const auto values_of = [](const RunRequest& request) {
    TestContext context;
    std::vector<double> values;
    for (const Attribute& a : run(request, context).mesh.attributes)
      values.insert(values.end(), a.values.begin(), a.values.end());
    return values;
  };
  const std::vector<double> of_file = values_of(ball.asks({"v", "side", "heat of it"}));
  CHECK(of_file.size() == 5 * 400);
  RunRequest request = ball.asks({"v"});
  request.input.given_grids = {grid_field(read_grid(*grids[4]), "side"),
                               grid_field(read_grid(*grids[3]), "heat of it")};
  CHECK(values_of(request) == of_file);
  request.input.grids = {};
  const std::string bytes = get_file(ball.folder / "ball.vdb");
  const View<const char> file{bytes.data(), int64_t(bytes.size())};
  request.input.given_grids = {grid_field_of_vdb(file, "v"), grid_field_of_vdb(file, "side"),
                               grid_field_of_vdb(file, "heat of it")};
  CHECK(values_of(request) == of_file);
  request.input.given_grids.push_back(request.input.given_grids[0]);
  CHECK(contains(refusal(request), "two grids 'v'"));
  CHECK(
      contains(message_of(ErrorCode::usage, [&] { grid_field(read_grid(*grids[5]), "mask"); }), "has type Tree_bool"));
  CHECK(contains(message_of(ErrorCode::usage, [&] { grid_field_of_vdb(file, "w"); }), "has no grid \"w\""));
}

TEST_CASE("grids: an array gives a result its values, and three of them a vector", "[grids][run]") {
  const Ball ball;
  constexpr int kSide = 17;
  std::vector<float> along[3], sides;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k) {
        const int at[3] = {i - 8, j - 8, k - 8};
        for (size_t axis = 0; axis < 3; ++axis) along[axis].push_back(.4f * float(at[axis]));
        sides.push_back(i > 8 ? 7.f : -7.f);
      }
  const auto volume_of = [](const std::vector<float>& values) {
    DenseVolume volume;
    volume.values = values.data();
    for (int64_t& size : volume.size) size = kSide;
    volume.stride[0] = int64_t(kSide) * kSide, volume.stride[1] = kSide, volume.stride[2] = 1;
    volume.step_world = {WorldPoint{.4, 0, 0}, WorldPoint{0, .4, 0}, WorldPoint{0, 0, .4}};
    volume.origin_world = {-3.2, -3.2, -3.2};
    return volume;
  };
  RunRequest request = ball.asks({});
  request.input.given_grids = {
      vector_field("at", {grid_field(volume_of(along[0]), "x"), grid_field(volume_of(along[1]), "y"),
                          grid_field(volume_of(along[2]), "z")}),
      grid_field(volume_of(sides), "side", true)};
  TestContext context;
  const RunResult result = run(request, context);
  const std::vector<Attribute>& of = result.mesh.attributes;
  REQUIRE(names_of(of) == Names{"at.0", "at.1", "at.2", "side"});
  double worst = 0;
  int64_t wrong_sides = 0;
  for (size_t i = 0; i < result.mesh.vertices.size(); ++i) {
    const WorldPoint& p = result.mesh.vertices[i];
    worst = std::max({worst, std::abs(named(of, "at.0").values[i] - p.x), std::abs(named(of, "at.1").values[i] - p.y),
                      std::abs(named(of, "at.2").values[i] - p.z)});
    wrong_sides += std::abs(p.x - .2) > .01 && named(of, "side").values[i] != (p.x > .2 ? 7 : -7);
  }
  CHECK(worst < 1e-5);
  CHECK(wrong_sides == 0);
  CHECK(named(of, "side").type == NumberType::i32);
}

TEST_CASE("grids: an array with values that a grid does not hold is refused by its place", "[grids][unit]") {
  std::vector<float> values(8, 1.f);
  DenseVolume volume;
  volume.values = values.data();
  for (int64_t& size : volume.size) size = 2;
  volume.stride[0] = 4, volume.stride[1] = 2, volume.stride[2] = 1;
  const auto refused = [&](float value, bool is_whole) {
    values[5] = value;
    return message_of(ErrorCode::usage, [&] { grid_field(volume, "heat", is_whole); });
  };
  CHECK(contains(refused(INFINITY, false), "heat: value [1, 0, 1] is inf; values are finite"));
  CHECK(contains(refused(1.5f, true), "heat: value [1, 0, 1] is 1.5; whole numbers are whole"));
  CHECK(contains(refused(33554432.f, true), "none is beyond 16777216"));
  values[5] = NAN;
  grid_field(volume, "heat", true);
  CHECK(contains(message_of(ErrorCode::out_of_memory, [&] { grid_field(volume, "heat", false, 1000); }), "raise"));
}

TEST_CASE("grids: those of other tiles have other digests", "[grids][unit]") {
  openvdb::initialize();
  std::vector<uint64_t> digests;
  for (const float value : {0.f, 1.f, 2.f}) {
    auto grid = openvdb::FloatGrid::create(0);
    if (value > 0) grid->tree().addTile(1, openvdb::Coord(8, 0, 0), value, true);
    grid->tree().setValueOn(openvdb::Coord(0, 0, 0), 5);
    digests.push_back(grid_field(read_grid(*grid), "heat")->digest());
  }
  CHECK(digests[0] != digests[1]);
  CHECK(digests[1] != digests[2]);
  CHECK(digests[0] != digests[2]);
}

TEST_CASE("grids: a frame is made again where those in memory are others", "[grids][sequence]") {
  const Ball ball;
  openvdb::io::File(path_of_frame(ball.folder / "in.##.vdb", 1)).write(ball_with_values());
  SequenceRequest request;
  request.frame = ball.asks({});
  request.frame.input.path = ball.folder / "in.##.vdb";
  request.frame.input.grid = "surface";
  request.frame.output = named_output(ball.folder / "out.##.ply", "", StopAfter::mesh);
  request.frames = {1, 1, 1};
  request.resume = true;
  const auto made_with = [&](double middle) {
    const auto grid = cube_of<openvdb::FloatGrid>("heat", heat_at, middle);
    request.frame.input.given_grids = {grid_field(read_grid(*grid), "heat")};
    TestContext context;
    return run_sequence(request, context).made;
  };
  CHECK(made_with(0) == 1);
  CHECK(made_with(0) == 0);
  CHECK(made_with(0.5) == 1);
}

TEST_CASE("grids: each frame of a sequence has its own, and is made again where they are others", "[grids][sequence]") {
  const Ball ball;
  const auto write_frame = [&](int frame, double middle) {
    auto grids = ball_with_values(0.1 * frame);
    grids[3] = cube_of<openvdb::FloatGrid>("heat", heat_at, middle);
    openvdb::io::File(path_of_frame(ball.folder / "in.##.vdb", frame)).write(grids);
    openvdb::io::File(path_of_frame(ball.folder / "more.##.vdb", frame)).write({grids[2]});
  };
  for (const int frame : {1, 2}) write_frame(frame, 0);
  SequenceRequest request;
  request.frame = ball.asks({"heat", ball.folder / "more.##.vdb:Cd"});
  request.frame.input.path = ball.folder / "in.##.vdb";
  request.frame.input.grid = "surface";
  request.frame.output = named_output(ball.folder / "out.##.ply", "", StopAfter::mesh);
  request.frames = {1, 2, 1};
  request.resume = true;
  std::vector<Names> names;
  request.after_frame = [&](int64_t, const RunResult& result) { names.push_back(names_of(result.mesh.attributes)); };
  TestContext context;
  CHECK(run_sequence(request, context).made == 2);
  CHECK(names == std::vector<Names>{{"heat", "color"}, {"heat", "color", "born", "vx", "vy", "vz"}});
  CHECK(run_sequence(request, context).found == 2);
  write_frame(2, 0.5);
  const SequenceResult again = run_sequence(request, context);
  CHECK(again.found == 1);
  CHECK(again.made == 1);
}
