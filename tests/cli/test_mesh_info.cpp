// vdb_meshinfo as people run it, on meshes whose counts are known by hand.
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "unit/region_cubes.h"

using namespace isoshell;

namespace {

const char* const kTetrahedron = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n";
const char* const kOpen = "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n";
const char* const kCrossing = "OFF\n6 2 0\n0 0 0\n4 0 0\n0 4 0\n1 1 -1\n1 1 1\n2 1 1\n3 0 1 2\n3 3 4 5\n";

nlohmann::json info_of(cli::Folder& folder, const std::string& arguments) {
  const auto r = folder.run(arguments + " --json");
  CAPTURE(r.err);
  REQUIRE(r.status == 0);
  return nlohmann::json::parse(r.out);
}

}  // namespace

TEST_CASE("mesh info: a tetrahedron is a closed 2-manifold of genus 0", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write("t.off", kTetrahedron);
  const auto topology = info_of(folder, "t.off")["topology"];
  CHECK(topology["closed_manifold"] == true);
  CHECK(topology["edges"] == 6);
  CHECK(topology["genus"] == 0);
  CHECK(topology["euler"] == 2);
  CHECK(topology["self_intersecting_pairs"] == 0);
  CHECK(topology["volume"].get<double>() == Approx(1. / 6));
}

TEST_CASE("mesh info: a tetrahedron without a face has one border of three edges", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write("t.off", kOpen);
  const auto topology = info_of(folder, "t.off")["topology"];
  CHECK(topology["closed_manifold"] == false);
  CHECK(topology["boundary_edges"] == 3);
  CHECK(topology["boundary_loops"] == 1);
}

TEST_CASE("mesh info: two triangles that cross are one pair", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write("t.off", kCrossing);
  CHECK(info_of(folder, "t.off")["topology"]["self_intersecting_pairs"] == 1);
}

TEST_CASE("mesh info: what cannot be written is refused before anything is read", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write("t.off", kTetrahedron);
  CHECK(folder.run("gone.off >&-").status == 4);
  const auto closed = folder.run("t.off --stats - >&-");
  CHECK(closed.status == 4);
  CHECK(contains(closed.err, "standard output: is closed"));
  CHECK(folder.run("gone.off --stats no/s.json").status == 4);
  CHECK(folder.run("gone.off --stats " + std::string(300, 'a')).status == 4);
  const auto itself = folder.run("t.off --stats ./t.off --force");
  CHECK(itself.status == 2);
  CHECK(contains(itself.err, "--stats ./t.off and MESH t.off are one file"));
  CHECK(folder.content("t.off") == kTetrahedron);
  for (const char* option : {"--ref", "--require", "--stats", "--threads", "--max-memory"}) {
    const auto empty = folder.run("t.off " + std::string(option) + " ''");
    CHECK(empty.status == 2);
    CHECK(contains(empty.err, std::string(option) + " has no value"));
  }
}

TEST_CASE("mesh info: a gate that is missed ends with 6", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write("t.off", kTetrahedron);
  folder.write("open.off", kOpen);
  folder.write("crossing.off", kCrossing);
  CHECK(folder.run("t.off --require closed,manifold,genus=0,no-self-intersections").status == 0);
  CHECK(folder.run("open.off --require closed").status == 6);
  CHECK(folder.run("crossing.off --require no-self-intersections").status == 6);
  CHECK(folder.run("t.off --ref t.off --require max-deviation=0.001").status == 0);
  CHECK(folder.run("t.off --require max-deviation=0.001").status == 2);
}

TEST_CASE("mesh info: a cloud is measured from its points to the mesh, whatever has borders", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write("t.off", kTetrahedron);
  folder.write("open.off", kOpen);
  folder.write("cloud.xyz", "0.1 0.1 0\n0.2 0.2 -3\n0.2 0.3 0\n0.1 0.1 0\n0 0 1\n");
  const auto info = info_of(folder, "open.off --ref cloud.xyz");
  CHECK(info["reference"]["kind"] == "points");
  CHECK(info["reference"]["vertices"] == 4);
  const auto& distance = info["distance"];
  CHECK(distance["to_reference"].is_null());
  CHECK(distance["hausdorff"].is_null());
  const auto& from = distance["from_reference"];
  CHECK(from["max"].get<double>() == Approx(3));
  CHECK(from["max_at_most"] == from["max"]);
  CHECK(from["mean"].get<double>() == Approx(.75));
  CHECK(from["rms"].get<double>() == Approx(1.5));
  CHECK(from["normal_mean_deg"].is_null());
  const auto table = folder.run("t.off --ref cloud.xyz");
  CHECK(contains(table.out, "Distance from the points of the reference to the mesh"));
  CHECK(contains(table.out, "not measured: they are no surface"));
  CHECK_FALSE(contains(table.out, "normal deviation"));
  CHECK(folder.run("t.off --ref cloud.xyz --require max-deviation=3.1").status == 0);
  const auto far = folder.run("t.off --ref cloud.xyz --require max-deviation=2.9");
  CHECK(far.status == 6);
  CHECK(contains(far.err, "the points are up to 3 from the mesh"));
  const auto normals = folder.run("t.off --ref cloud.xyz --require normal-deviation=5");
  CHECK(normals.status == 2);
  CHECK(contains(normals.err, "normal-deviation compares surfaces, and cloud.xyz is points; leave it out"));
}

TEST_CASE("mesh info: an open result is near to the cloud that it was made of", "[cli][mesh_info]") {
  cli::Folder folder;
  std::string points, grid = "OFF\n441 800 0\n", faces;
  for (int i = 0; i < 441; ++i) {
    const std::string at = std::to_string(i % 21) + " " + std::to_string(i / 21) + " 0\n";
    points += at;
    grid += at;
    const int right = i + 1, above = i + 21;
    if (i % 21 == 20 || i / 21 == 20) continue;
    faces += "3 " + std::to_string(i) + " " + std::to_string(right) + " " + std::to_string(above) + "\n3 " +
             std::to_string(right) + " " + std::to_string(above + 1) + " " + std::to_string(above) + "\n";
  }
  folder.write("cloud.xyz", points);
  folder.write("sheet.off", grid + faces);
  CHECK(info_of(folder, "sheet.off --ref cloud.xyz")["distance"]["from_reference"]["max"] == 0);
}

TEST_CASE("mesh info: a pattern of frames is refused as what another command takes", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write("t.0001.off", kTetrahedron);
  folder.write("t.off", kTetrahedron);
  for (const char* const arguments : {"t.####.off", "t.%04d.off", "t.off --ref t.####.off"}) {
    const auto r = folder.run(arguments);
    CHECK(r.status == 3);
    CHECK(r.err.find("only vdb_isomesh with --frames, as 1-240, takes a pattern") != std::string::npos);
  }
}

TEST_CASE("mesh info: gates see the topology that the certificate shows", "[cli][mesh_info]") {
  cli::Folder folder;
  const char* const moebius =
      "OFF\n5 5 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n3 0 1 2\n3 1 2 3\n3 2 3 4\n3 3 4 0\n3 4 0 1\n";
  folder.write("moebius.off", moebius);
  folder.write("pair.off", "OFF\n4 5 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n3 0 2 1\n");
  folder.write("repeated.off", "OFF\n4 5 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n3 1 1 2\n");
  folder.write("loose.off", "OFF\n5 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 9 9\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  CHECK(info_of(folder, "moebius.off")["topology"]["boundary_loops"] == 1);
  CHECK(folder.run("moebius.off --require boundary-loops=1,components=1").status == 0);
  CHECK(folder.run("moebius.off --require manifold").status == 6);
  CHECK(folder.run("pair.off --require closed").status == 0);
  CHECK(folder.run("pair.off --require genus=0").status == 6);
  CHECK(folder.run("repeated.off --require closed").status == 0);
  CHECK(folder.run("repeated.off --require manifold").status == 6);
  CHECK(folder.run("repeated.off --require genus=0").status == 6);
  CHECK(folder.run("loose.off --require closed,genus=0,components=1").status == 0);
  CHECK(folder.run("loose.off --require manifold").status == 6);
}

TEST_CASE("mesh info: the bytes of the table and of the JSON are the same for 1 and 4 threads", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write_off("mesh.off", shapes::together(shapes::torus(2, .7, 180, 90), shapes::sphere({2, 0, 0}, 1, 60)));
  folder.write_off("reference.off", shapes::torus(2, .71, 120, 60));
  for (const std::string form : {"", " --json"}) {
    const std::string arguments = "mesh.off --ref reference.off --require max-deviation=.1" + form;
    const auto one = folder.run(arguments + " --threads 1"), four = folder.run(arguments + " --threads 4");
    CHECK(one.status == 6);
    CHECK(four.status == 6);
    CHECK(one.out.size() > 1000);
    CHECK(one.out == four.out);
    CHECK(one.err == four.err);
  }
}

TEST_CASE("mesh info: a glTF mesh is measured where its nodes put it", "[cli][mesh_info]") {
  cli::Folder folder;
  const TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  write_mesh(folder / "box.gltf", {box.vertices, box.triangles});
  nlohmann::json scene = nlohmann::json::parse(folder.content("box.gltf"));
  scene["nodes"] = {{{"children", {1}}, {"translation", {10, 0, 0}}}, {{"mesh", 0}, {"scale", {-2, 3, 4}}}};
  scene["scenes"] = {{{"nodes", {0}}}};
  folder.write("placed.gltf", scene.dump());
  folder.write_off("expected.off", shapes::box({8, 0, 0}, {10, 3, 4}));
  const auto info = info_of(folder, "placed.gltf --ref expected.off");
  CHECK(info["topology"]["closed_manifold"] == true);
  CHECK(info["topology"]["inverted_components"] == 0);
  CHECK(info["topology"]["volume"].get<double>() == Approx(24));
  CHECK(info["quality"]["area"].get<double>() == Approx(52));
  CHECK(info["distance"]["hausdorff"].get<double>() == Approx(0).margin(1e-6));
}

TEST_CASE("mesh info: files that cannot be measured are refused", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write("index.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 7\n");
  folder.write("empty.off", "OFF\n3 0 0\n0 0 0\n1 0 0\n0 1 0\n");
  CHECK(folder.run("index.off").status == 3);
  CHECK(folder.run("empty.off").status == 5);
  CHECK(folder.run("missing.off").status == 3);
}

TEST_CASE("mesh info: walls of regions are judged by the regions that they close", "[cli][mesh_info][regions]") {
  cli::Folder folder;
  TriangleMesh mesh = two_cubes();
  mesh.regions.names = {{1, "grey matter"}, {2, "bone"}};
  write_mesh(folder / "cubes.ply", mesh, {"ply"});
  remove_face(mesh, face_between(mesh, {2, 0}));
  write_mesh(folder / "open.ply", mesh, {"ply"});
  const auto table = folder.run("cubes.ply --require regions,closed,manifold");
  CHECK(table.status == 0);
  CHECK(contains(table.out, "walls of closed regions"));
  CHECK(contains(table.out, "1 (grey matter)"));
  CHECK_FALSE(contains(table.out, "non-manifold"));
  const auto regions = info_of(folder, "cubes.ply")["regions"];
  REQUIRE(regions["regions"].size() == 2);
  CHECK(regions["regions"][1]["name"] == "bone");
  CHECK(regions["regions"][1]["volume"].get<double>() == Approx(1));
  CHECK(regions["walls"].size() == 3);
  const auto open = folder.run("open.ply --require regions");
  CHECK(open.status == 6);
  CHECK(contains(open.err, "gate failed: regions: region 2 (bone) is not closed"));
}

TEST_CASE("mesh info: the version has a short name", "[cli][mesh_info]") {
  cli::Folder folder;
  const auto r = folder.run("-V");
  CHECK(r.status == 0);
  CHECK(r.out.find("vdb_meshinfo ") == 0);
  CHECK(r.out == folder.run("--version").out);
}

TEST_CASE("mesh info: an option of other programs is not taken for one that only vdb_isomesh has", "[cli][mesh_info]") {
  cli::Folder folder;
  folder.write("t.off", kTetrahedron);
  const auto foreign = folder.run("t.off --triangles");
  CHECK(foreign.status == 2);
  CHECK(contains(foreign.err, "unknown option --triangles; see --help"));
  CHECK(contains(folder.run("t.off --overwrite").err, "did you mean --force?"));
  CHECK(contains(folder.run("t.off --njobs").err, "did you mean --threads?"));
}
