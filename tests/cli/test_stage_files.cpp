// Whole runs of the command that keep stage files, and go on from them.
#include "cli/command.h"
#include "cli/quick_ball.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using namespace isoshell::cli;

#ifdef ISOSHELL_TEST_VDB
TEST_CASE("run: resumed from either stage file, the result is the same, byte by byte", "[cli][vdb]") {
  Folder folder;
  write_ball(folder);
  for (const std::string& method : {std::string("sheet"), std::string("shell")}) {
    const std::string options = kQuick + "--force --seed 7 --method " + method;
    REQUIRE(folder.run("ball.off once.ply --save-shell s.vdb --save-voronoi v.vdb" + options).status == 0);
    REQUIRE(folder.run("ball.off shell.vdb --stop-after shell" + options).status == 0);
    REQUIRE(folder.run("ball.off voronoi.vdb --stop-after voronoi" + options).status == 0);
    CHECK(folder.content("s.vdb") == folder.content("shell.vdb"));
    CHECK(folder.content("v.vdb") == folder.content("voronoi.vdb"));
    REQUIRE(folder.run("shell.vdb from_shell.ply --force").status == 0);
    REQUIRE(folder.run("voronoi.vdb from_voronoi.ply --force").status == 0);
    REQUIRE(folder.run("shell.vdb voronoi2.vdb --force --stop-after voronoi").status == 0);
    CHECK(folder.content("once.ply") == folder.content("from_shell.ply"));
    CHECK(folder.content("once.ply") == folder.content("from_voronoi.ply"));
    CHECK(folder.content("voronoi.vdb") == folder.content("voronoi2.vdb"));
  }
}

TEST_CASE("run: stage files go through pipes, and are those that files hold", "[cli][vdb]") {
  Folder folder;
  write_ball(folder);
  const std::string command = "'" + command_path() + "' ", resume = command + "- piped.ply --input-format vdb --force";
  for (const std::string& stage : {std::string("shell"), std::string("voronoi")}) {
    const std::string stop = " --stop-after " + stage + kQuick;
    REQUIRE(folder.run("ball.off file.vdb --force" + stop).status == 0);
    REQUIRE(folder.run("ball.off -" + stop + "> piped.vdb").status == 0);
    CHECK(folder.content("file.vdb") == folder.content("piped.vdb"));
    CHECK_FALSE(folder.has("-.preview.vdb"));
    REQUIRE(folder.run("file.vdb file.ply --force").status == 0);
    REQUIRE(folder.run("ball.off -" + stop + "| " + resume).status == 0);
    CHECK(folder.content("file.ply") == folder.content("piped.ply"));
  }
  const auto damaged = folder.shell("head -c 2000 file.vdb | " + resume);
  CHECK(damaged.status == 3);
  CHECK(contains(damaged.err, "standard input"));
  CHECK(folder.shell("cat file.vdb | " + resume + " --max-memory 100K").status == 7);
  REQUIRE(folder.run("ball.off out.ply --save-shell -" + kQuick + "> saved.vdb").status == 0);
  CHECK(folder.run("saved.vdb resumed.ply").status == 0);
}

TEST_CASE("run: a level set is written on the way, or instead of a mesh, and meshed again through a pipe",
          "[cli][vdb]") {
  Folder folder;
  write_ball(folder);
  REQUIRE(folder.run("ball.off out.ply --save-level-set a.vdb --level-set-band 4" + kQuick).status == 0);
  REQUIRE(folder.run("ball.off b.vdb --stop-after level-set --level-set-band 4" + kQuick).status == 0);
  CHECK(folder.content("a.vdb") == folder.content("b.vdb"));
  const std::string again = "'" + command_path() + "' - again.ply --input-format vdb" + kQuick;
  REQUIRE(folder.run("ball.off - --stop-after level-set" + kQuick + "| " + again).status == 0);
  CHECK(folder.has("again.ply"));
  REQUIRE(
      folder.run("ball.off s.vdb --save-level-set t.vdb --stop-after level-set --level-set-band 4" + kQuick).status ==
      0);
  CHECK(folder.content("s.vdb") == folder.content("a.vdb"));
  CHECK(folder.content("t.vdb") == folder.content("a.vdb"));
  REQUIRE(folder.run("ball.off shell.vdb --stop-after shell" + kQuick).status == 0);
  const auto resumed = folder.run("shell.vdb of_stage.vdb --stop-after level-set");
  CHECK(resumed.status == 0);
  CHECK_FALSE(contains(resumed.err, " 0 active voxels"));
  CHECK(folder.run("ball.off - --output-format ply --save-level-set -" + kQuick).status == 2);
  CHECK(folder.run("ball.off c.vdb --stop-after level-set --save-voronoi v.vdb" + kQuick).status == 2);
  CHECK(folder.run("ball.off c.vdb --stop-after level-set --level-set-band 0.5" + kQuick).status == 2);
  CHECK_FALSE(folder.has("c.vdb"));
  CHECK(folder.run("ball.off c.vdb --stop-after level-set --regions components" + kQuick).status == 2);
}

TEST_CASE("run: a run that resumes says which attributes it is without, and where they are", "[cli][vdb]") {
  Folder folder;
  folder.write("quad.ply",
               "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
               "property float heat\nproperty float salt\nelement face 4\nproperty list uchar int vertex_indices\n"
               "end_header\n0 0 0 1 5\n1 0 0 2 6\n0 1 0 3 7\n0 0 1 4 8\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 0 3 2\n");
  const std::string quick = " --vertices 200 --device cpu --force";
  const std::string heat = " of quad.ply, and not cut along their seams: a stage file does not hold them";
  REQUIRE(folder.run("quad.ply s.vdb --stop-after shell" + quick).status == 0);
  CHECK(contains(folder.run("s.vdb out.ply" + quick).err, "s.vdb: the result is without heat, salt" + heat));
  REQUIRE(folder.run("quad.ply out.ply --save-shell s.vdb --attributes heat" + quick).status == 0);
  CHECK(contains(folder.run("s.vdb out.ply" + quick).err, "s.vdb: the result is without heat" + heat));
  REQUIRE(folder.run("quad.ply out.ply --save-shell s.vdb --attributes none" + quick).status == 0);
  CHECK_FALSE(contains(folder.run("s.vdb out.ply" + quick).err, "without"));
}

TEST_CASE("run: every file that a stage is kept in is looked at before any work", "[cli][vdb]") {
  Folder folder;
  write_ball(folder);
  fs::create_directory(folder / "a.vdb.d");
  folder.write("v.preview.vdb", "precious");
  for (const char* run : {"ball.off out.ply --save-voronoi v.vdb", "ball.off v.vdb --stop-after voronoi"}) {
    const auto r = folder.run(run + kQuick);
    CHECK(r.status == 4);
    CHECK(contains(r.err, "v.preview.vdb: exists already"));
  }
  CHECK(folder.run("ball.off out.ply --save-voronoi w.vdb --save-shell ./w.preview.vdb" + kQuick).status == 2);
  REQUIRE(folder.run("ball.off out.ply --save-voronoi a.vdb.d/x" + kQuick).status == 0);
  CHECK(folder.has("a.vdb.d/x.preview.vdb"));
}

TEST_CASE("run: options that a stage file has fixed are refused where they differ", "[cli][vdb]") {
  Folder folder;
  write_ball(folder);
  REQUIRE(folder.run("ball.off shell.vdb --stop-after shell" + kQuick).status == 0);
  CHECK(folder.run("shell.vdb out.ply --resolution 64").status == 2);
  CHECK(folder.run("shell.vdb out.ply --vertices 200").status == 0);
  CHECK(read_mesh((folder / "out.ply").string()).vertices.size() == 200);
  REQUIRE(folder.run("ball.off voronoi.vdb --stop-after voronoi" + kQuick).status == 0);
  CHECK(folder.run("voronoi.vdb out2.ply --vertices 200").status == 2);
  CHECK(contains(folder.run("shell.vdb out3.ply --method shell --adaptivity 1").err, "--method sheet"));
  REQUIRE(folder.run("ball.off paper.vdb --stop-after shell --method shell" + kQuick).status == 0);
  CHECK(contains(folder.run("paper.vdb out3.ply --adaptivity 1").err, "--method sheet"));
  folder.write("fake.vdb", folder.content("shell.vdb").substr(0, 3000));
  CHECK(folder.run("fake.vdb out3.ply").status == 3);
  for (const char* differs :
       {"--vertices 200", "--edge-length 1", "--adaptivity 1", "--gradation 1.5", "--method shell", "--iterations 3",
        "--tolerance 0.1", "--step 1", "--seed 1", "--resolution 64", "--voxel-size 0.3", "--band 3",
        "--close-gaps 4vox", "--close-gaps 1e300", "--outer-only"}) {
    const auto r = folder.run(std::string("voronoi.vdb no.ply ") + differs);
    INFO(differs << ": " << r.err);
    CHECK(r.status == 2);
    CHECK(contains(r.err, "is fixed by the voronoi stage file: it was "));
  }
  CHECK(contains(folder.run("voronoi.vdb no.ply --vertices 200").err, "it was 300; leave it out"));
  CHECK(contains(folder.run("voronoi.vdb no.ply --edge-length 1").err, "it was not given; leave it out"));
  CHECK(contains(folder.run("shell.vdb no.ply --close-gaps 4vox").err, "it was 0vox; leave it out"));
  REQUIRE(folder.run("ball.off closed.vdb --stop-after shell --close-gaps 0" + kQuick).status == 0);
  CHECK(contains(folder.run("closed.vdb no.ply --close-gaps auto").err, "it was 0vox; leave it out"));
  CHECK_FALSE(folder.has("no.ply"));
}

TEST_CASE("run: bodies within a voxel of one another stay apart from a shell file, too, and a Voronoi file joins them",
          "[cli][vdb]") {
  Folder folder;
  const auto ball = [](double radius) { return shapes::sphere({1, 2, 3}, radius, 48); };
  folder.write_off("nested.off", shapes::together(shapes::together(ball(1), shapes::inside_out(ball(.98))), ball(.96)));
  REQUIRE(folder.run("nested.off once.ply --vertices 900 --save-shell s.vdb --require components=3").status == 0);
  REQUIRE(folder.run("s.vdb resumed.ply --require components=3").status == 0);
  CHECK(folder.content("once.ply") == folder.content("resumed.ply"));
  const auto joined = folder.run("nested.off joined.ply --vertices 900 --save-voronoi v.vdb");
  CHECK(joined.status == 0);
  CHECK(contains(joined.err, "may tell near parts apart"));
}

TEST_CASE("run: options that a stage file has fixed may be given as they were", "[cli][vdb]") {
  Folder folder;
  write_ball(folder);
  const std::string made =
      " --vertices 300 --voxel-size 0.21 --close-gaps 1 --band 3 --outer-only --gradation 1.3 --iterations 9 ";
  REQUIRE(
      folder.run("ball.off once.ply --save-shell s.vdb --save-voronoi v.vdb --seed 7 --step 2 --tolerance 0.001" + made)
          .status == 0);
  CHECK(folder.run("s.vdb shell.ply" + made).status == 0);
  CHECK(
      folder.run("v.vdb voronoi.ply --method sheet --adaptivity 0 --seed 7 --step 2 --tolerance 0.001" + made).status ==
      0);
  CHECK(folder.content("once.ply") == folder.content("shell.ply"));
  CHECK(folder.content("once.ply") == folder.content("voronoi.ply"));
  REQUIRE(folder.run("ball.off e.vdb --stop-after voronoi --resolution 48 --edge-length 1.5").status == 0);
  const auto count = folder.run("e.vdb e.ply --edge-length 1.5 --resolution 48");
  CHECK(count.status == 0);
  const int64_t vertices = int64_t(read_mesh((folder / "e.ply").string()).vertices.size());
  CHECK(folder.run("e.vdb again.ply --vertices " + std::to_string(vertices)).status == 0);
  CHECK(folder.content("e.ply") == folder.content("again.ply"));
  CHECK(folder.run("e.vdb usual.ply --vertices 10000").status == 2);
  CHECK(folder.run("e.vdb auto.ply --close-gaps auto").status == 0);
  CHECK(folder.content("e.ply") == folder.content("auto.ply"));
}
#endif
