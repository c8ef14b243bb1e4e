// Whole runs of the command: meshes, statistics, gates, pipes, interruption.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "cli/command.h"
#include "cli/quick_ball.h"
#include "isoshell/io/vdb_file.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using namespace isoshell::cli;
using Json = nlohmann::json;

namespace {

std::set<std::string> keys(const Json& object) {
  std::set<std::string> names;
  for (const auto& item : object.items()) names.insert(item.key());
  return names;
}

}  // namespace

TEST_CASE("run: a surface becomes a closed mesh of the asked size, in the input's coordinates", "[cli]") {
  Folder folder;
  write_ball(folder);
  const auto r = folder.run("ball.off out.ply --require closed,manifold,genus=0,components=1" + kQuick);
  CHECK(r.status == 0);
  CHECK(r.out.empty());
  CHECK(contains(r.err, "300 vertices"));
  const TriangleSoup mesh = read_mesh((folder / "out.ply").string());
  CHECK(mesh.vertices.size() == 300);
  CHECK(mesh.triangles.size() == 596);
  for (const WorldPoint& p : mesh.vertices) {
    const double r_sq = (p.x - 1) * (p.x - 1) + (p.y - 2) * (p.y - 2) + (p.z - 3) * (p.z - 3);
    CHECK(r_sq > 4.5 * 4.5);
    CHECK(r_sq < 5.3 * 5.3);
  }
  CHECK(folder.file_count() == 2);
}

TEST_CASE("run: statistics have every key of schema 1, and null for what is not measured", "[cli]") {
  Folder folder;
  write_ball(folder);
  const auto r = folder.run("ball.off out.ply --stats - -q --device cpu" + kQuick);
  REQUIRE(r.status == 0);
  CHECK(r.err.empty());
  const Json j = Json::parse(r.out);
  CHECK(j["schema"] == 1);
  for (const char* name : {"input", "grid", "counts", "topology", "quality", "distance", "energy", "timings_ms",
                           "memory_bytes", "device", "digests", "warnings"})
    CHECK(j.contains(name));
  CHECK(j["input"]["kind"] == "mesh");
  CHECK(j["input"]["closed"] == true);
  CHECK(j["grid"]["resolution"] == 48);
  CHECK(j["counts"]["vertices"] == 300);
  CHECK(j["counts"]["triangles"] == 596);
  CHECK(j["topology"]["genus"] == 0);
  CHECK(j["topology"]["manifold"] == true);
  CHECK(j["topology"]["self_intersections"] == 0);
  CHECK(j["distance"]["unit"] == "world");
  CHECK(j["distance"]["to_input_mean"] > 0);
  CHECK(j["distance"]["to_input_rms"] >= j["distance"]["to_input_mean"]);
  CHECK(j["distance"]["hausdorff"] >= j["distance"]["to_input_max"]);
  CHECK(j["distance"]["hausdorff"] >= j["distance"]["from_input_max"]);
  CHECK(j["distance"]["pct_of_diagonal"]["hausdorff"] < 2);
  CHECK(j["device"] == "cpu");
  CHECK(j["device_details"].is_null());
  CHECK(j["memory_bytes"]["device_peak"].is_null());
  CHECK(j["quality"]["q_avg"] > 0.8);
  CHECK(j["memory_bytes"]["host_peak"] > 0);
  CHECK(j["timings_ms"]["total"] > 0);
  CHECK(keys(j["digests"]) == std::set<std::string>{"mesh", "samples", "seeds", "sheet", "sites", "surface"});
}

TEST_CASE("run: a run on a device names it and gives the bytes of the CPU", "[.device]") {
  Folder folder;
  write_ball(folder);
  const auto r = folder.run("ball.off out.off --stats out.json -v --device cuda:0" + kQuick);
  REQUIRE(r.status == 0);
  const Json j = Json::parse(folder.content("out.json"));
  CHECK(j["device"] == "cuda");
  CHECK(j["device_details"]["number"] == 0);
  const std::string name = j["device_details"]["name"];
  CHECK_FALSE(name.empty());
  CHECK(contains(r.err, "device: cuda:0, " + name));
  CHECK(j["memory_bytes"]["device_peak"] > 0);
  REQUIRE(folder.run("ball.off cpu.off --device cpu" + kQuick).status == 0);
  CHECK(folder.content("cpu.off") == folder.content("out.off"));
  const auto capped = folder.run("ball.off capped.off --device cuda --max-memory 1M" + kQuick);
  CHECK(capped.status == 7);
  CHECK(contains(capped.err, "--max-memory"));
}

TEST_CASE("run: a gate that fails exits with 6 and still writes the mesh", "[cli]") {
  Folder folder;
  write_ball(folder);
  const auto r =
      folder.run("ball.off out.ply --require genus=1,min-angle=59.9,max-deviation=1e-6 --stats out.json" + kQuick);
  CHECK(r.status == 6);
  CHECK(contains(r.err, "gate failed: genus=1: the mesh has 0"));
  CHECK(contains(r.err, "gate failed: min-angle=59.9"));
  CHECK(contains(r.err, "gate failed: max-deviation=1e-06: the result is up to"));
  CHECK(folder.has("out.ply"));
  CHECK(folder.has("out.json"));
  CHECK(folder.run("ball.off near.ply --require max-deviation=0.1" + kQuick).status == 0);
}

TEST_CASE("run: a result that intersects itself exits with 6 and is written, unless that is allowed", "[cli]") {
  Folder folder;  // two squares that cross
  TriangleSoup squares;
  squares.vertices = {{-1, -1, 0},  {1, -1, 0},  {1, 1, 0},  {-1, 1, 0},
                      {.1, -1, -1}, {.1, 1, -1}, {.1, 1, 1}, {.1, -1, 1}};
  squares.triangles = {{0, 1, 2}, {0, 2, 3}, {4, 5, 6}, {4, 6, 7}};
  folder.write_off("squares.off", squares);
  const std::string few = " --vertices 100 --boundary keep --device cpu ";
  const auto r = folder.run("squares.off out.ply --stats out.json" + few);
  CHECK(r.status == 6);
  CHECK(contains(r.err, "pairs of triangles intersect, near "));
  CHECK(contains(r.err, "gate failed: the result intersects itself in "));
  CHECK(contains(r.err, "--allow-intersections takes it as it is"));
  const Json j = Json::parse(folder.content("out.json"));
  CHECK(j["topology"]["self_intersections"] > 0);
  CHECK(j["topology"]["intersection_at"].size() == 3);
  CHECK(read_mesh((folder / "out.ply").string()).vertices.size() == 100);
  const auto allowed = folder.run("squares.off allowed.ply --allow-intersections" + few);
  CHECK(allowed.status == 0);
  CHECK(contains(allowed.err, "pairs of triangles intersect, near "));
  CHECK(folder.content("allowed.ply") == folder.content("out.ply"));
}

TEST_CASE("run: a wall that so few vertices cannot follow takes more, and a warning says why", "[cli]") {
  Folder folder;  // a hollow ball: four vertices for each side are too few, however thick its wall is made
  folder.write_off("hollow.off", shapes::together(shapes::sphere({0, 0, 0}, 1, 32),
                                                  shapes::inside_out(shapes::sphere({0, 0, 0}, .97, 32))));
  const auto r = folder.run("hollow.off out.ply --stats out.json --vertices 8 --resolution 140 --device cpu");
  CHECK(r.status == 0);
  const Json j = Json::parse(folder.content("out.json"));
  CHECK(j["topology"]["self_intersections"] == 0);
  CHECK(j["topology"]["components"] == 2);
  CHECK(contains(r.err, " vertices instead of 8: parts of the surface are nearer to one another than edges are long"));
  CHECK(read_mesh((folder / "out.ply").string()).vertices.size() < 20);
}

TEST_CASE("run: standard input and output carry meshes, and the same bytes as files", "[cli]") {
  Folder folder;
  write_ball(folder);
  REQUIRE(folder.run("ball.off file.off" + kQuick).status == 0);
  const auto piped =
      folder.shell("cat ball.off | '" + command_path() + "' - - --input-format off --output-format off" + kQuick);
  CHECK(piped.status == 0);
  CHECK(piped.out == folder.content("file.off"));
  CHECK_FALSE(piped.out.empty());
  std::ostringstream cloud;
  cloud << "ply\nformat ascii 1.0\nelement vertex 600\nproperty float x\nproperty float y\nproperty float "
           "z\nend_header\n";
  for (int i = 0; i < 600; ++i) {  // a spiral of even steps on a ball
    const double z = 1 - (2 * i + 1) / 600., r = std::sqrt(1 - z * z);
    cloud << r * std::cos(2.399963 * i) << " " << r * std::sin(2.399963 * i) << " " << z << "\n";
  }
  folder.write("cloud.ply", cloud.str());
  REQUIRE(folder.run("cloud.ply points.off --require closed,components=1" + kQuick).status == 0);
  const std::string from_ply = " --input-format ply --output-format off" + kQuick;
  const auto points = folder.shell("cat cloud.ply | '" + command_path() + "' - -" + from_ply);
  CHECK(points.status == 0);
  CHECK(points.out == folder.content("points.off"));
  const auto fifo = folder.shell("mkfifo pipe; cat cloud.ply > pipe & '" + command_path() + "' pipe -" + from_ply);
  CHECK(fifo.out == folder.content("points.off"));
  CHECK(folder.shell("'" + command_path() + "' - -" + from_ply + " < /dev/null").status == 5);
  const auto full = folder.run("ball.off out.off --stats - > /dev/full" + kQuick);
  CHECK(full.status == 4);
}

TEST_CASE("run: the number of threads and the order of faces do not change a byte", "[cli]") {
  Folder folder;
  write_ball(folder);
  TriangleSoup turned = shapes::sphere({1, 2, 3}, 5, 48);
  std::reverse(turned.triangles.begin(), turned.triangles.end());
  folder.write_off("turned.off", turned);
  REQUIRE(folder.run("ball.off one.ply --threads 1" + kQuick).status == 0);
  REQUIRE(folder.run("ball.off three.ply --threads 3" + kQuick).status == 0);
  REQUIRE(folder.run("turned.off turned.ply" + kQuick).status == 0);
  CHECK(folder.content("one.ply") == folder.content("three.ply"));
  CHECK(folder.content("one.ply") == folder.content("turned.ply"));
  REQUIRE(folder.run("ball.off other.ply --seed 1" + kQuick).status == 0);
  CHECK(folder.content("one.ply") != folder.content("other.ply"));
}

TEST_CASE("run: --force replaces, and a failed run leaves the old file", "[cli]") {
  Folder folder;
  write_ball(folder);
  folder.write("out.ply", "old");
  folder.write("empty.off", "OFF\n0 0 0\n");
  CHECK(folder.run("empty.off out.ply --force" + kQuick).status == 5);
  CHECK(folder.content("out.ply") == "old");
  CHECK(folder.run("ball.off out.ply --force" + kQuick).status == 0);
  CHECK(folder.content("out.ply") != "old");
  CHECK(folder.file_count() == 3);
}

TEST_CASE("run: dirt is counted in one line a kind, and quiet says nothing", "[cli]") {
  Folder folder;
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 5, 48);
  ball.vertices.push_back({9, 9, 9});
  ball.triangles.push_back({0, 0, 1});
  ball.triangles.push_back(ball.triangles[0]);
  folder.write_off("dirty.off", ball);
  const auto r = folder.run("dirty.off out.ply" + kQuick);
  CHECK(r.status == 0);
  CHECK(contains(r.err, "warning: dirty.off: 1 faces without area"));
  CHECK(contains(r.err, "1 repeated faces"));
  CHECK(contains(r.err, "1 vertices that no face uses"));
  CHECK(folder.run("dirty.off quiet.ply -q --threads 4096" + kQuick).err.empty());
}

TEST_CASE("run: a PLY file that holds more than its header declares is read with a warning", "[cli]") {
  Folder folder;
  std::ostringstream mesh, points;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 5, 48);
  for (std::ostringstream* file : {&mesh, &points})
    *file << "ply\nformat ascii 1.0\nelement vertex " << ball.vertices.size()
          << "\nproperty float x\nproperty float y\nproperty float z\n";
  mesh << "element face " << ball.triangles.size() << "\nproperty list uchar int vertex_indices\n";
  for (std::ostringstream* file : {&mesh, &points}) {
    *file << "end_header\n";
    for (const WorldPoint& p : ball.vertices) *file << p.x << " " << p.y << " " << p.z << " 255\n";
  }
  for (const auto& t : ball.triangles) mesh << "3 " << t[0] << " " << t[1] << " " << t[2] << " 0\n";
  folder.write("mesh.ply", mesh.str() + "0 1\n");
  folder.write("points.ply", points.str() + "1 2 3\n");
  const auto said = [&](const std::string& input, size_t long_rows) {
    const auto r = folder.run(input + " out.ply --force --stats out.json --require closed,manifold,genus=0" + kQuick);
    const Json dropped = Json::parse(folder.content("out.json"))["input"]["dropped"];
    return r.status == 0 && contains(r.err, "rows with values behind their last declared property") &&
           contains(r.err, "1 rows left out behind the last") && dropped["long_rows"] == long_rows &&
           dropped["surplus_rows"] == 1;
  };
  CHECK(said("mesh.ply", ball.vertices.size() + ball.triangles.size()));
  CHECK(said("points.ply", ball.vertices.size()));
  folder.write("few.ply", mesh.str().substr(0, mesh.str().size() - 20));
  CHECK(folder.run("few.ply few_out.ply" + kQuick).status == 3);
}

TEST_CASE("run: a PLY cloud with a face that is none is meshed as the cloud, with a warning", "[cli]") {
  Folder folder;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 5, 48);
  std::ostringstream rows;
  for (const WorldPoint& p : ball.vertices) rows << p.x << " " << p.y << " " << p.z << "\n";
  const std::string head = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(ball.vertices.size()) +
                           "\nproperty float x\nproperty float y\nproperty float z\n";
  folder.write("cloud.ply", head + "end_header\n" + rows.str());
  folder.write("face.ply", head + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + rows.str() +
                               "3 0 1 1\n");
  REQUIRE(folder.run("cloud.ply cloud.off" + kQuick).status == 0);
  const auto r = folder.run("face.ply face.off --stats -" + kQuick);
  CHECK(r.status == 0);
  CHECK(contains(r.err, "face.ply: none of its faces is usable (1); it is read as a point cloud"));
  const Json input = Json::parse(r.out)["input"];
  CHECK(input["kind"] == "points");
  CHECK(input["dropped"]["degenerate_faces"] == 1);
  CHECK(folder.content("face.off") == folder.content("cloud.off"));
}

TEST_CASE("run: an angle that is poor is said with its place", "[cli]") {
  Folder folder;
  folder.write_off("wire.off", shapes::torus(1, .02, 200, 12));
  const auto few = folder.run("wire.off few.ply --device cpu --vertices 100");
  CHECK(few.status == 0);
  CHECK(contains(few.err, "below 30 degrees: "));
  CHECK(contains(few.err, "more --vertices make better triangles"));
  CHECK_FALSE(contains(folder.run("wire.off enough.ply --device cpu --vertices 2000").err, "below 30 degrees"));
}

TEST_CASE("run: progress is lines of JSON when asked, and none without a terminal", "[cli]") {
  Folder folder;
  write_ball(folder);
  const auto r = folder.run("ball.off out.ply -q --progress json" + kQuick);
  REQUIRE(r.status == 0);
  std::istringstream lines(r.err);
  std::vector<std::string> stages;
  std::vector<double> fractions;
  for (std::string line; std::getline(lines, line);) {
    const Json j = Json::parse(line);
    if (stages.empty() || stages.back() != j["stage"]) stages.push_back(j["stage"]);
    fractions.push_back(j["fraction"]);
    CHECK((j["stage_fraction"] >= 0 && j["stage_fraction"] <= 1));
    CHECK(j["seconds_left"] >= 0);
  }
  CHECK(stages == std::vector<std::string>{"read", "prepare", "relax", "triangulate", "measure", "write"});
  CHECK((fractions.front() == 0 && fractions.back() == 1));
  CHECK(std::is_sorted(fractions.begin(), fractions.end()));
  CHECK_FALSE(contains(folder.run("ball.off out2.ply" + kQuick).err, "["));
}

TEST_CASE("run: an interrupted run exits with 130 and leaves nothing", "[cli]") {
  Folder folder;
  folder.write_off("ball.off", shapes::sphere({1, 2, 3}, 5, 200));
  const std::string shell_too = can_write_vdb() ? " --save-shell shell.vdb" : "";
  // Once it works, which its first line says. A shell has what runs beside it ignore the signal, hence env.
  const auto r = folder.shell("mkfifo said; env --default-signal=INT '" + command_path() +
                              "' ball.off out.ply --device cpu --vertices 400000 --stats out.json" + shell_too +
                              " --progress json 2>said & "
                              "exec 3<said; read first <&3; kill -INT $!; cat <&3 >&2; wait $!");
  CHECK(r.status == 130);
  CHECK(contains(r.err, "interrupted"));
  CHECK_FALSE(folder.has("out.ply"));
  CHECK_FALSE(folder.has("out.json"));
}

TEST_CASE("run: a damaged surface is mended, said so, and becomes one closed body", "[cli]") {
  Folder folder;
  TriangleSoup soup = shapes::sphere({1, 2, 3}, 5, 48);
  const WorldPoint corner = soup.vertices[soup.triangles[900][0]];
  soup.vertices.push_back({1.05 * (corner.x - 1) + 1, 1.05 * (corner.y - 2) + 2, 1.05 * (corner.z - 3) + 3});  // a fin
  shapes::add_triangle(soup, soup.triangles[900][0], soup.triangles[900][1], uint32_t(soup.vertices.size() - 1));
  for (size_t i = 0; i < soup.triangles.size(); i += 3) std::swap(soup.triangles[i][1], soup.triangles[i][2]);
  soup.triangles.erase(soup.triangles.begin() + 500, soup.triangles.begin() + 540);
  folder.write_off("broken.off", soup);
  const auto r = folder.run("broken.off out.ply --stats - --require closed,manifold,genus=0,components=1" + kQuick);
  REQUIRE(r.status == 0);
  CHECK(contains(r.err, "holes closed by new faces"));
  CHECK(contains(r.err, "faces turned"));
  CHECK(contains(r.err, "fins dropped"));
  const Json j = Json::parse(r.out);
  CHECK(j["input"]["closed"] == false);
  CHECK(j["input"]["mended"]["capped_loops"] > 0);
  CHECK(j["input"]["mended"]["open_loops"] == 0);
  CHECK(j["gaps"]["loops"] == j["input"]["mended"]["capped_loops"]);
  CHECK(j["gaps"]["area"] > 0);
  CHECK(contains(folder.content("out.ply"), "property uchar gap"));
  CHECK(j["grid"]["closing"] == 0);
  CHECK(j["topology"]["agrees_with_input"] == true);
  CHECK(folder.run("broken.off out2.ply --close-gaps 0 --stats - -q" + kQuick).out.find("\"capped_loops\": 0") !=
        std::string::npos);
}
