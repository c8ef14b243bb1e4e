// Sizing fields and adaptivity: what files are taken, and what meshes become of them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "isoshell/error.h"
#include "isoshell/io/sizing_vdb.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/sizing_fields.h"

using namespace isoshell;
using namespace isoshell::cli;
using Json = nlohmann::json;

namespace {

TestGrid constant(const std::string& name, double value, double background = 0) {
  return sizing_grid(name, 1.2, 0.2, background, [=](WorldPoint) { return value; });
}

/// What reading says, or nothing when it is fine.
std::string complaint(const std::string& source, int64_t max_bytes = 0) {
  return message_of(max_bytes > 0 ? ErrorCode::out_of_memory : ErrorCode::unreadable_input,
                    [&] { read_sizing(source, max_bytes); });
}

void write_ball(const Folder& folder) { folder.write_off("ball.off", shapes::sphere({0, 0, 0}, 1, 64)); }

const std::string kGrid = " --resolution 96 -q --device cpu --stats ";

}  // namespace

TEST_CASE("sizing: between voxels lengths are interpolated, outside the background counts if it is one", "[sizing]") {
  Folder folder;
  const std::string path = (folder / "f.vdb").string();
  const auto upper = [](WorldPoint p) { return p.z > -0.01 ? 2 + p.z : 0; };
  write_grids(path, {sizing_grid("a", 1, 0.25, -3, upper)});
  const std::vector<WorldPoint> points = {{0, 0, 0.5}, {0.1, 0.2, 0.3}, {0, 0, -0.125}, {0, 0, -0.5}, {9, 0, 0}};
  const std::vector<double> at = read_sizing(path)->lengths_at(points);
  CHECK(std::abs(at[0] - 2.5) < 1e-6);
  CHECK(std::abs(at[1] - 2.3) < 1e-6);
  CHECK(std::abs(at[2] - 2) < 1e-6);  // only the active voxels around it count
  CHECK(at[3] == 0);
  CHECK(at[4] == 0);
  write_grids(path, {sizing_grid("a", 1, 0.25, 7, upper)});
  const std::vector<double> with_background = read_sizing(path)->lengths_at(points);
  CHECK(with_background[3] == 7);
  CHECK(with_background[4] == 7);
  CHECK(std::abs(with_background[2] - 4.5) < 1e-6);
}

TEST_CASE("sizing: lengths in memory are the field that a file of them is, and NaN says nothing", "[sizing]") {
  constexpr int kSide = 4;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const auto length = [](int i, int j, int k) { return i == 3 ? 0.f : 1 + 0.25f * float(i) + 0.5f * float(j * k); };
  TestGrid grid("a", 0, 0.5, {-1, 2, 3});
  std::vector<float> values;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k) {
        values.push_back(length(i, j, k) > 0 ? length(i, j, k) : nan);
        if (length(i, j, k) > 0) grid.set(i, j, k, length(i, j, k));
      }
  Folder folder;
  const std::string path = (folder / "lengths.vdb").string();
  write_grids(path, {grid});
  DenseVolume dense{values.data(),
                    {kSide, kSide, kSide},
                    {kSide * kSide, kSide, 1},
                    {WorldPoint{.5, 0, 0}, {0, .5, 0}, {0, 0, .5}},
                    {-1, 2, 3}};

  std::vector<WorldPoint> points;
  for (int i = 0; i < 300; ++i) points.push_back({-1.3 + 0.0087 * i, 1.8 + 0.0071 * i, 4.6 - 0.0063 * i});
  const std::vector<double> at = sizing_of(dense, "lengths")->lengths_at(points);
  CHECK(at == read_sizing(path)->lengths_at(points));
  CHECK(std::count(at.begin(), at.end(), 0) > 0);
  CHECK(std::count(at.begin(), at.end(), 0) < 300);
  dense.step_world[1] = dense.step_world[0];
  CHECK_THROWS_AS(sizing_of(dense, "lengths"), Error);
}

TEST_CASE("sizing: files that are no sizing fields are refused with what is wrong and what to do", "[sizing]") {
  Folder folder;
  const auto file = [&](const std::string& name, const std::vector<TestGrid>& grids) {
    write_grids((folder / name).string(), grids);
    return (folder / name).string();
  };
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  const auto one_bad = [](double bad) {
    auto grid = constant("a", 0.1);
    grid.set(2, -1, 3, bad);
    return grid;
  };
  CHECK(complaint(file("good.vdb", {constant("a", 0.1)})).empty());
  CHECK(contains(complaint(file("nan.vdb", {one_bad(nan)})), "[2, -1, 3]"));
  CHECK(contains(complaint(file("inf.vdb", {one_bad(inf)})), "no edge length"));
  CHECK(contains(complaint(file("zero.vdb", {one_bad(0)})), "more than 0"));
  auto distances = constant("a", -0.5);
  distances.call_it_a_level_set();
  CHECK(contains(complaint(file("level_set.vdb", {distances})), "level set"));
  CHECK(contains(complaint(file("empty.vdb", {TestGrid("a", 0.1)})), "no active voxels"));
  TestGrid whole = TestGrid::of_integers("b");
  whole.set(0, 0, 0, 3);
  CHECK(contains(complaint(file("int.vdb", {whole})), "no grid of floats"));
  const std::string two = file("two.vdb", {constant("a", 0.1), constant("c", 0.2), whole});
  CHECK(contains(complaint(two), "several grids"));
  CHECK(complaint(two + ":c").empty());
  CHECK(contains(complaint(two + ":d"), "\"a\""));
  CHECK(contains(complaint(two + ":b"), "Tree_int32_5_4_3"));
  const std::string same = file("same.vdb", {constant("a", 0.1), constant("a", 0.2)});
  CHECK(complaint(same + ":a[1]").empty());
  CHECK(contains(complaint(same + ":a"), "\"a[0]\""));
  const std::string literal = file("literal.vdb", {constant("a", 0.1), constant("a[1]", 0.2), constant("a", 0.3)});
  const std::vector<WorldPoint> middle = {{0, 0, 0}};
  for (const auto& [grid, length] : {std::pair<const char*, double>{":a[0]", 0.1}, {":a[1]", 0.2}, {":a[2]", 0.3}})
    CHECK(std::abs(read_sizing(literal + grid)->lengths_at(middle)[0] - length) < 1e-6);
  CHECK(contains(complaint((folder / "none.vdb").string()), "none.vdb"));
  folder.write("text.vdb", "no grid at all");
  CHECK(!complaint((folder / "text.vdb").string()).empty());
  const std::string bytes = folder.content("good.vdb");
  folder.write("cut.vdb", bytes.substr(0, bytes.size() / 2));
  CHECK(!complaint((folder / "cut.vdb").string()).empty());
  CHECK(contains(complaint(two, 100), "--max-memory"));
}

TEST_CASE("sizing: the command refuses what it cannot use, by its exit status", "[sizing][cli]") {
  Folder folder;
  write_ball(folder);
  write_grids((folder / "bad.vdb").string(), {constant("a", -1)});
  CHECK(folder.run("ball.off o.ply --sizing bad.vdb" + kGrid + "s.json").status == 3);
  CHECK(folder.run("ball.off o.ply --sizing none.vdb" + kGrid + "s.json").status == 3);
  CHECK(folder.run("ball.off o.ply --adaptivity 1.5" + kGrid + "s.json").status == 2);
  CHECK(folder.run("ball.off o.ply --gradation 1" + kGrid + "s.json").status == 2);
  CHECK(folder.run("ball.off o.ply --adaptivity .5 --method shell" + kGrid + "s.json").status == 2);
  CHECK(!folder.has("o.ply"));
}

TEST_CASE("sizing: a field of one length gives the bytes that no field gives", "[sizing][cli]") {
  Folder folder;
  write_ball(folder);
  write_grids((folder / "even.vdb").string(), {constant("a", 0.125)});
  const std::string all = " -q --device cpu";
  REQUIRE(folder.run("ball.off count.ply --vertices 600" + all).status == 0);
  REQUIRE(folder.run("ball.off count_field.ply --vertices 600 --sizing even.vdb --gradation 1.1" + all).status == 0);
  CHECK(folder.content("count.ply") == folder.content("count_field.ply"));
  REQUIRE(folder.run("ball.off edge.ply --edge-length .125" + all).status == 0);
  REQUIRE(folder.run("ball.off edge_field.ply --sizing even.vdb:a" + all).status == 0);
  CHECK(folder.content("edge.ply") == folder.content("edge_field.ply"));
  REQUIRE(folder.run("ball.off adapt.ply --vertices 600 --adaptivity 0" + all).status == 0);
  CHECK(folder.content("count.ply") == folder.content("adapt.ply"));
}

TEST_CASE("sizing: edges follow a field, alone and with a count, and a resumed run has the same bytes",
          "[sizing][cli]") {
  Folder folder;
  write_ball(folder);
  write_grids((folder / "f.vdb").string(), {ball_sizing(0.1, 3)});
  REQUIRE(folder.run("ball.off o.ply --sizing f.vdb --require manifold,genus=0" + kGrid + "s.json").status == 0);
  const Json s = Json::parse(folder.content("s.json"));
  CHECK(s["sizing"]["edge_error_mean"] < 0.15);
  CHECK(s["sizing"]["min"] < 0.12);
  CHECK(s["sizing"]["max"] > 0.25);
  CHECK(s["quality"]["q_avg"] > 0.9);
  REQUIRE(folder.run("ball.off k.ply --sizing f.vdb --vertices 500" + kGrid + "k.json").status == 0);
  const Json k = Json::parse(folder.content("k.json"));
  CHECK(k["counts"]["vertices"] == 500);
  CHECK(k["sizing"]["edge_error_mean"] < 0.15);
  REQUIRE(folder.run("ball.off o.shell.vdb --sizing f.vdb --stop-after shell" + kGrid + "t.json").status == 0);
  REQUIRE(folder.run("o.shell.vdb r.ply -q --device cpu").status == 0);
  CHECK(folder.content("r.ply") == folder.content("o.ply"));
  REQUIRE(folder.run("ball.off o.voronoi.vdb --sizing f.vdb --stop-after voronoi" + kGrid + "v.json").status == 0);
  REQUIRE(folder.run("o.voronoi.vdb v.ply --sizing f.vdb -q --device cpu").status == 0);
  CHECK(folder.content("v.ply") == folder.content("o.ply"));
  CHECK(contains(folder.run("o.voronoi.vdb w.ply --sizing other.vdb").err, "it was f.vdb; leave it out"));
}

TEST_CASE("sizing: creases stay with a field and with adaptivity, and a resumed run has the same bytes",
          "[sizing][cli]") {
  Folder folder;
  folder.write_off("box.off", shapes::box({-.9, -.9, -.9}, {.9, .9, .9}));
  write_grids((folder / "f.vdb").string(), {ball_sizing(0.12, 3)});
  for (const std::string requested : {"--sizing f.vdb", "--sizing f.vdb --vertices 500 --uniform-area --fit surface",
                                      "--vertices 500 --adaptivity 1 --uniform-area"}) {
    const std::string quick = " -q --device cpu --force ";
    REQUIRE(
        folder.run("box.off o.ply --require manifold,features,genus=0 --stats s.json " + requested + quick).status ==
        0);
    const Json s = Json::parse(folder.content("s.json"));
    CHECK(s["features"]["kept"] == true);
    if (contains(requested, "--vertices")) CHECK(s["counts"]["vertices"] == 500);
    if (contains(requested, "--sizing")) CHECK(s["sizing"]["edge_error_mean"] < 0.15);
    CHECK(s["distance"]["hausdorff"] < 0.002);
    REQUIRE(folder.run("box.off o.shell.vdb --stop-after shell " + requested + quick).status == 0);
    REQUIRE(folder.run("o.shell.vdb r.ply" + quick).status == 0);
    CHECK(folder.content("r.ply") == folder.content("o.ply"));
  }
}

TEST_CASE("sizing: adaptivity puts the same number of vertices where the surface is curved", "[sizing][cli]") {
  Folder folder;
  folder.write_off("torus.off", shapes::torus(1, 0.25, 120, 40));
  REQUIRE(folder.run("torus.off o.ply --vertices 700 --adaptivity .7" + kGrid + "s.json").status == 0);
  const Json s = Json::parse(folder.content("s.json"));
  CHECK(s["counts"]["vertices"] == 700);
  CHECK(s["topology"]["genus"] == 1);
}

TEST_CASE("sizing: adaptivity brings the mesh nearer to a surface of uneven curvature", "[sizing][cli]") {
  Folder folder;
  TriangleSoup egg = shapes::sphere({0, 0, 0}, 1, 120);
  for (WorldPoint& p : egg.vertices) p.x *= 4;
  folder.write_off("egg.off", egg);
  double largest[2];
  for (const int adaptivity : {0, 1}) {
    const std::string requested = " --vertices 700 -q --device cpu --stats s.json --force --adaptivity ";
    REQUIRE(folder.run("egg.off o.ply" + requested + std::to_string(adaptivity)).status == 0);
    const Json s = Json::parse(folder.content("s.json"));
    largest[adaptivity] = s["distance"]["hausdorff"];
    CHECK(s["quality"]["q_avg"] > 0.93);
    CHECK(s["topology"]["self_intersections"] == 0);
  }
  CHECK(largest[1] < 0.5 * largest[0]);
}

TEST_CASE("sizing: lengths that the grid or the density does not carry are bounded with a warning", "[sizing][cli]") {
  Folder folder;
  write_ball(folder);
  write_grids((folder / "f.vdb").string(), {ball_sizing(0.03, 40)});
  const auto coarse = folder.run("ball.off c.ply --sizing f.vdb --resolution 64 --device cpu");
  CHECK(coarse.status == 0);
  CHECK(contains(coarse.err, "carries none shorter"));
  CHECK(contains(coarse.err, "--resolution"));
  const auto wide = folder.run("ball.off w.ply --sizing f.vdb --resolution 300 --gradation 4 --device cpu");
  CHECK(wide.status == 0);
  CHECK(contains(wide.err, "16 times"));
}
