// Features as a user asks for them: lines from files, colours, requirements, statistics.
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "geometry/world_vector.h"
#include "isoshell/io/polyline_file.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "voxel/random.h"

using namespace isoshell;
using namespace isoshell::cli;
using Json = nlohmann::json;

namespace {

const std::string kQuick = " --vertices 600 --device cpu --force ";

/// A cross on the upper face of the box from -1 to 1, the second line of which leaves the box.
const char* const kCross = "v -1 -1 1\nv 1 1 1\nv -1 0 1\nv 1 0 1\nv 3 0 1\nl 1 2\nl 3 4 5\n";

void write_box(const Folder& folder) { folder.write_off("box.off", shapes::box({-1, -1, -1}, {1, 1, 1})); }

}  // namespace

TEST_CASE("features: lines of a file become edges, and what is off the surface is named", "[cli][features]") {
  Folder folder;
  write_box(folder);
  folder.write("cross.obj", kCross);
  const auto r = folder.run("box.off out.ply --features auto,cross.obj --stats s.json" + kQuick);
  CHECK(r.status == 0);
  CHECK(contains(r.err, "1 segment of 3 segments of lines to keep is left out; cross.obj, line 7: it is 2 from"));
  const Json j = Json::parse(folder.content("s.json"));
  CHECK(j["options"]["features"] == "auto,cross.obj");
  CHECK(j["features"]["kept"] == true);
  CHECK(j["features"]["lines"] == 4);    // the cross in four parts
  CHECK(j["features"]["curves"] == 18);  // and the box's edges, two of which it parts
  CHECK(j["features"]["lost"].size() == 1);
  CHECK(j["features"]["lost"][0]["kind"] == "line");
  CHECK(j["features"]["lost"][0]["index"] == 2);
  CHECK(j["features"]["segments"] > 50);
  CHECK(j["normals"]["to_input_mean_deg"] < .5);
  CHECK(j["normals"]["from_input_max_deg"] < 10);

  const auto off = folder.run("box.off off.ply --features off,cross.obj --stats s.json" + kQuick);
  CHECK(off.status == 0);
  const Json only = Json::parse(folder.content("s.json"));
  CHECK(only["features"]["curves"] == only["features"]["lines"]);
}

TEST_CASE("features: sharp edges that are taken for noise are told of, unless there are few", "[cli][features]") {
  Folder folder;
  TriangleSoup rough = shapes::sphere({0, 0, 0}, 1, 40);
  for (size_t v = 0; v < rough.vertices.size(); ++v) {
    const double out = 1 + .08 * (double(random_bits(3, v) % 1001) / 1000 - .5);
    rough.vertices[v] = out * rough.vertices[v];
  }
  folder.write_off("rough.off", rough);
  const auto r = folder.run("rough.off out.ply" + kQuick);
  CHECK(r.status == 0);
  CHECK(contains(r.err, " of sharp edges taken for noise (--features DEG keeps them), "));
  write_box(folder);
  CHECK(!contains(folder.run("box.off out.ply" + kQuick).err, "taken for noise"));
}

TEST_CASE("features: files of lines that cannot be used are refused", "[cli][features]") {
  Folder folder;
  write_box(folder);
  folder.write("bad.obj", "v 0 0 1\nv 1 0 1\nl 1 3\n");
  folder.write("far.obj", "v 0 0 9\nv 1 0 9\nl 1 2\n");
  const auto run = [&](const std::string& features) {
    return folder.run("box.off out.ply --features " + features + kQuick);
  };
  const auto bad = run("auto,bad.obj");
  CHECK(bad.status == 3);
  CHECK(contains(bad.err, "bad.obj, line 3: a line names vertex 3; the file holds vertices 1 to 2"));
  const auto far = run("auto,far.obj");
  CHECK(far.status == 2);
  CHECK(contains(far.err, "no line to keep is on the surface; far.obj, line 3: it is 8 from the surface"));
  CHECK(run("auto,none.obj").status == 3);
  CHECK(run("auto,").status == 2);
  CHECK(run("auto,box.off").status == 2);
  CHECK(run("off,far.obj --method shell").status == 2);
  CHECK(run("off,far.obj --save-voronoi v.vdb").status == 2);
  CHECK_FALSE(folder.has("out.ply"));
}

TEST_CASE("features: colors show patches and curves, and the edges of curves can be given again", "[cli][features]") {
  Folder folder;
  write_box(folder);
  REQUIRE(folder.run("box.off out.ply --color-features" + kQuick).status == 0);
  const TriangleSoup mesh = read_mesh((folder / "out.ply").string());
  REQUIRE(mesh.attributes.size() == 2);
  for (const Attribute& a : mesh.attributes) {
    CHECK(a.name == "color");
    CHECK(a.components == 3);
  }
  const Attribute& of_vertex = mesh.attributes[mesh.attributes[0].domain == AttributeDomain::vertex ? 0 : 1];
  int corners = 0;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const WorldPoint& p = mesh.vertices[v];
    const auto is_at = [](double x) { return std::abs(std::abs(x) - 1) < 1e-3; };
    const int sides = is_at(p.x) + is_at(p.y) + is_at(p.z);
    const double* color = &of_vertex.values[3 * v];
    CHECK((color[0] + color[1] + color[2] == 0) == (sides == 2));
    corners += color[0] == 255 && color[1] == 0;
  }
  CHECK(corners == 8);
  const auto edges = read_polylines((folder / "out.ply").string());
  double length = 0;
  for (const auto& [a, b] : edges->segments) {
    const WorldPoint &p = edges->points[a], &q = edges->points[b];
    length += std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z));
  }
  CHECK(std::abs(length - 24) < .01);
  CHECK(folder.run("box.off again.ply --features off,out.ply --require features" + kQuick).status == 0);

  const auto stl = folder.run("box.off out.stl --color-features" + kQuick);
  CHECK(stl.status == 2);
  CHECK(contains(stl.err, "--color-features needs a PLY file"));
  REQUIRE(folder.run("box.off plain.ply" + kQuick).status == 0);
  CHECK(read_mesh((folder / "plain.ply").string()).attributes.empty());
}

TEST_CASE("features: requirements on normals and curves end with 6 where they are missed", "[cli][features]") {
  Folder folder;
  write_box(folder);
  CHECK(folder.run("box.off out.ply --require features,normal-deviation=.5" + kQuick).status == 0);
  const auto round = folder.run("box.off out.ply --features off --require normal-deviation=.5" + kQuick);
  CHECK(round.status == 6);
  CHECK(contains(round.err, "gate failed: normal-deviation=0.5: normals of the result deviate by"));
  TriangleSoup open = shapes::box({-1, -1, -1}, {1, 1, 1});  // loses its lid
  const auto is_on_top = [&](const std::array<uint32_t, 3>& t) {
    return std::all_of(t.begin(), t.end(), [&](uint32_t v) { return open.vertices[v].z == 1; });
  };
  open.triangles.erase(std::remove_if(open.triangles.begin(), open.triangles.end(), is_on_top), open.triangles.end());
  folder.write_off("open.off", open);
  const auto lost = folder.run("open.off out.ply --require features --stats s.json" + kQuick);
  CHECK(lost.status == 6);
  CHECK(contains(lost.err, "gate failed: features: "));
  const Json j = Json::parse(folder.content("s.json"));
  CHECK(j["features"]["kept"] == false);
  CHECK(j["features"]["lost_curves"] == 8);
  CHECK(j["features"]["lost_by_reason"].size() == 1);
  CHECK(j["features"]["lost_by_reason"][0]["curves"] == 8);
  CHECK(j["features"]["lost_by_reason"][0]["length"] == j["features"]["lost_length"]);
  CHECK(j["features"]["lost"].size() == 8);
  CHECK(j["features"]["lost"][0]["reason"] == j["features"]["given_up"]);
  CHECK(j["features"]["lost"][0]["length"] > 0);
}

#ifdef ISOSHELL_TEST_VDB
TEST_CASE("features: resumed from a shell, lines are read again", "[cli][vdb][features]") {
  Folder folder;
  write_box(folder);
  folder.write("cross.obj", kCross);
  for (const char* features : {"auto,cross.obj", "30,cross.obj --color-features"}) {
    REQUIRE(folder.run("box.off whole.ply --save-shell s.vdb --features " + (features + kQuick)).status == 0);
    REQUIRE(folder.run("s.vdb resumed.ply --device cpu --force").status == 0);
    CHECK(folder.content("whole.ply") == folder.content("resumed.ply"));
  }
}
#endif
