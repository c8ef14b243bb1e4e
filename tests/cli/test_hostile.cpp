// What a hostile or unlucky user gives the command: damaged files, surfaces that are hardly surfaces, absurd sizes.
#include <sys/resource.h>

#include <sstream>

#include "cli/command.h"
#include "isoshell/io/file_format.h"
#include "isoshell/io/vdb_file.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using namespace isoshell::cli;

namespace {

const std::string kSmall = " --vertices 60 --resolution 24 --force ";

std::string malformed(const std::string& name) {
  return "'" + source_folder() + "/tests/data/malformed/" + name + "' ";
}

/// The file as a closed mesh of the asked size.
bool becomes_closed(Folder& folder, const std::string& input) {
  return folder.run(input + " out.ply --require closed,manifold" + kSmall).status == 0;
}

TriangleSoup ball_at(WorldPoint centre, double radius) { return shapes::sphere(centre, radius, 24); }

}  // namespace

TEST_CASE("hostile: a file that lies is refused with 3, one without triangles with 5, and named", "[cli][hostile]") {
  Folder folder;
  struct Expected {
    const char* name;
    int status;
  };
  for (const Expected& e : {Expected{"assimp_OutOfMemory.off", 3},
                            {"assimp_crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply", 3},
                            {"assimp_empty.obj", 5},
                            {"assimp_invalid.off", 3},
                            {"assimp_malformed.obj", 3},
                            {"tinyobj_invalid-face-definition.obj", 5},
                            {"tinyobj_issue-140-zero-face-idx.obj", 3},
                            {"tinyobj_test-nan.obj", 0},
                            {"trimesh_notenoughindices.obj", 0},
                            {"trimesh_ply_empty_header.ply", 5},
                            {"trimesh_stl_empty_bin.stl", 5}}) {
    const auto r = folder.run(malformed(e.name) + "out.ply" + kSmall);
    INFO(e.name << ": " << r.err);
    CHECK(r.status == e.status);
    CHECK(contains(r.err, e.name));
    CHECK(folder.has("out.ply") == (e.status == 0));
    fs::remove(folder / "out.ply");
  }
}

TEST_CASE("hostile: files of every format that promise what they do not hold are refused by name", "[cli][hostile]") {
  Folder folder;
  struct Written {
    const char *name, *text;
    int status;
  };
  for (const Written& w :
       {Written{"neg_count.ply", "ply\nformat ascii 1.0\nelement vertex -3\nend_header\n", 3},
        {"huge_count.ply",
         "ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\nproperty float "
         "z\nend_header\n0 0 0\n",
         3},
        {"no_z.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
         3},
        {"deep.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99999999999999999999\n", 3},
        {"words.obj", "v a b c\nf 1 1 1\n", 3},
        {"inf.obj", "v inf 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 5},
        {"extension.gltf", R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_node_visibility"]})", 3},
        {"draco.gltf",
         R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"data:;base64,RFJBQ08CAgEB"}],)"
         R"("bufferViews":[{"buffer":0,"byteLength":9}],"accessors":[{"componentType":5126,"count":3,"type":"VEC3"},)"
         R"({"componentType":5125,"count":3,"type":"SCALAR"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},)"
         R"("indices":1,"extensions":{"KHR_draco_mesh_compression":{"bufferView":0,"attributes":{"POSITION":0}}}}]}]})",
         3},
        {"no_file.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"none.bin"}]})", 3},
        {"outside.gltf", R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":9,"uri":"../a.bin"}]})", 3},
        {"cut.glb", "glTF\2", 3},
        {"empty.gltf", R"({"asset":{"version":"2.0"}})", 5},
        {"four.off", "4OFF\n1 1 0\n", 3},
        {"overflow.off", "OFF\n9223372036854775807 9223372036854775807 0\n", 3},
        {"long_face.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n999999999 0 1 2\n", 3},
        {"cut.stl", "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0\n", 3},
        {"nan.xyz", "nan nan nan\nnan nan nan\n", 5},
        {"short.xyz", "1 2 3\n4 5\n", 3},
        {"line.xyz", "0 0 0\n1 0 0\n2 0 0\n3 0 0\n5 0 0\n", 5},
        {"words.xyz", "hello\nworld\n", 3},
        {"no_data.pcd", "VERSION 0.7\nFIELDS x y z\nPOINTS 3\n", 3},
        {"liar.pcd", "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 4000000000\nDATA binary\nabc", 3},
        {"overflow.pcd",
         "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nWIDTH 4294967294\nHEIGHT 4294967294\nDATA binary\nabc", 3},
        {"bomb.pcd", "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 4000000\nDATA binary_compressed\nabcd",
         3},
        {"empty.vdb", "", 5},
        {"text.vdb", "not a volume at all, but longer than a header would be, and so it is looked at", 3},
        {"text.nvdb", "NanoVDB0 and then nothing that makes sense, for long enough to be looked at", 3}}) {
    folder.write(w.name, w.text);
    const auto r = folder.run(w.name + std::string(" out.ply") + kSmall);
    INFO(w.name << ": " << r.err);
    CHECK(r.status == w.status);
    CHECK_FALSE(folder.has("out.ply"));
  }
}

TEST_CASE("hostile: one triangle, a flat quad and twins become closed meshes", "[cli][hostile]") {
  Folder folder;
  folder.write("triangle.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  folder.write("quad.off", "OFF\n4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n");
  folder.write("twins.off", "OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n3 0 1 2\n");
  CHECK(becomes_closed(folder, "triangle.off"));
  CHECK(becomes_closed(folder, "quad.off"));
  CHECK(becomes_closed(folder, "twins.off"));
}

TEST_CASE("hostile: a surface without area is nothing to mesh", "[cli][hostile]") {
  Folder folder;
  folder.write("line.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n2 0 0\n3 0 1 2\n");
  folder.write("point.off", "OFF\n3 1 0\n5 5 5\n5 5 5\n5 5 5\n3 0 1 2\n");
  const auto line = folder.run("line.off out.ply" + kSmall);
  CHECK(line.status == 5);
  CHECK(contains(line.err, "area"));
  CHECK(folder.run("point.off out.ply" + kSmall).status == 5);
  CHECK_FALSE(folder.has("out.ply"));
}

TEST_CASE("hostile: far from the origin, tiny and huge surfaces are meshed where they are", "[cli][hostile]") {
  Folder folder;
  folder.write_off("tiny.off", ball_at({0, 0, 0}, 1e-6));
  folder.write_off("huge.off", ball_at({0, 0, 0}, 1e6));
  CHECK(becomes_closed(folder, "tiny.off"));
  CHECK(becomes_closed(folder, "huge.off"));
  std::string far = "OFF\n4 4 0\n";  // of unit size, a million away: more digits than a float has
  far += "1000000.125 1000000 1000000\n1000001 1000000 1000000\n1000000 1000001 1000000\n1000000 1000000 1000001\n";
  folder.write("far.off", far + "3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  CHECK(becomes_closed(folder, "far.off"));
}

TEST_CASE("hostile: absurd sizes are refused with a size that would do", "[cli][hostile]") {
  Folder folder;
  folder.write_off("ball.off", ball_at({0, 0, 0}, 1));
  for (const char* run : {"ball.off out.ply --edge-length 1e-9", "ball.off --dry-run --edge-length 1e-9",
                          "ball.off out.ply --edge-length 1e-300"}) {
    const auto tiny = folder.run(run);
    CHECK(tiny.status == 2);
    CHECK(contains(tiny.err, "2147483647"));
    CHECK(contains(tiny.err, "use at least"));
  }
  for (const char* length : {"1e300", "1.7976931348623157e308", "3"}) {
    const auto huge = folder.run("ball.off out.ply --edge-length " + std::string(length));
    INFO(huge.err);
    CHECK(huge.status == 2);
    CHECK(contains(huge.err, "asks for fewer than 4 vertices; use at most 1.89"));
  }
  CHECK(folder.run("ball.off most.ply --edge-length 1.89").status == 0);
  for (const char* length : {"inf", "nan"})
    CHECK(contains(folder.run("ball.off out.ply --edge-length " + std::string(length)).err,
                   std::string("is ") + length + "; it must be more than 0 and finite"));
  const auto many = folder.run("ball.off out.ply --vertices 1000000000 --max-memory 4G");
  CHECK(many.status == 7);
  CHECK(contains(many.err, "a result of 1,000,000,000 vertices needs about"));
  CHECK(contains(many.err, "ask for fewer by --vertices or longer edges, or raise --max-memory"));
  const auto fine = folder.run("ball.off out.ply --voxel-size 1e-9");
  CHECK(fine.status == 2);
  CHECK(contains(fine.err, "a voxel size of 1e-09 gives more than 8192 voxels"));
  const auto coarse = folder.run("ball.off out.ply --voxel-size 1e9");
  CHECK(coarse.status == 2);
  CHECK(contains(coarse.err, "a voxel size of 1e+09 gives fewer than 8 voxels"));
  CHECK(folder.run("ball.off out.ply --vertices 10000000 --resolution 16").status == 2);
  CHECK_FALSE(folder.has("out.ply"));
}

TEST_CASE("hostile: an interrupted run ends with 130 at any moment and leaves nothing behind", "[cli][hostile]") {
  Folder folder;
  folder.write_off("ball.off", shapes::sphere({0, 0, 0}, 1, 300));
  folder.write("old.ply", "old");
  const std::string shell_too = can_write_vdb() ? " --save-shell s.vdb" : "";
  for (const char* seconds : {"0.02", "0.1", "0.2", "0.35", "0.6", "1"}) {
    const auto r =
        folder.shell("timeout --foreground --preserve-status -s INT " + std::string(seconds) + " '" + command_path() +
                     "' ball.off old.ply --force --vertices 60000 --stats s.json" + shell_too);
    INFO(seconds << ": " << r.err);
    CHECK((r.status == 130 || r.status == 0));
    if (contains(r.err, "; ")) CHECK(contains(r.err, folder.has("s.vdb") ? "written before: s.vdb" : "nothing was"));
    if (r.status == 0) break;  // done before: a faster machine than the rest needs
    CHECK(folder.content("old.ply") == "old");
    fs::remove(folder / "s.vdb");  // kept whole, when the run came that far
    CHECK(folder.file_count() == 2);
  }
}

TEST_CASE("hostile: a folder that is full or vanishes leaves the old file as it was", "[cli][hostile]") {
  Folder folder;
  folder.write_off("ball.off", ball_at({0, 0, 0}, 1));
  folder.write("old.ply", "old");
  const auto full = folder.shell("ulimit -f 8; '" + command_path() + "' ball.off old.ply --vertices 4000 --force");
  CHECK(full.status == 4);
  CHECK(folder.content("old.ply") == "old");
  CHECK(folder.file_count() == 2);
  // It vanishes while the input is read, which comes by a pipe.
  const auto gone = folder.shell("mkdir gone; mkfifo pipe.off; '" + command_path() +
                                 "' pipe.off gone/out.ply --vertices 400 --resolution 60 & "
                                 "{ rmdir gone; cat ball.off; } >pipe.off; wait $!");
  CHECK(gone.status == 4);
}

namespace {

struct Ended {
  int status;
  int64_t most_bytes;  ///< of memory, of the largest process
};

/// Runs a line of the shell, its standard error into err.txt.
Ended measured(Folder& folder, const std::string& line) {
  const std::string whole = "cd '" + (folder / "").string() + "' && ( " + line + " ) 2>err.txt";
  const pid_t child = fork();
  if (child == 0) {
    execl("/bin/sh", "sh", "-c", whole.c_str(), nullptr);
    _exit(127);
  }
  int ended = 0;
  rusage used{};
  wait4(child, &ended, 0, &used);
  return {WIFEXITED(ended) ? WEXITSTATUS(ended) : 128 + WTERMSIG(ended), int64_t(used.ru_maxrss) * 1024};
}

std::string listed_inputs() {
  std::string words;
  for (const FileFormat& format : file_formats()) words += " " + format.name;
  return words;
}

}  // namespace

TEST_CASE("hostile: standard input that never ends is refused at the limit of memory", "[cli][hostile]") {
  Folder folder;
  std::istringstream formats(listed_inputs());
  for (std::string format; formats >> format;) {
    const Ended ended = measured(
        folder, "cat /dev/zero | '" + command_path() + "' - out.ply --input-format " + format + " --max-memory 100M");
    INFO(format << ": " << folder.content("err.txt"));
    CHECK(ended.status == 7);
    CHECK(contains(folder.content("err.txt"), "standard input: needs at least 100"));
    CHECK(contains(folder.content("err.txt"), "raise --max-memory, or split the file"));
    CHECK(ended.most_bytes < int64_t(200) << 20);
    CHECK(!folder.has("out.ply"));
  }
}

TEST_CASE("hostile: a small stack is enough", "[cli][hostile]") {
  Folder folder;
  folder.write_off("ball.off", ball_at({0, 0, 0}, 1));
  folder.write("box.obj",
               "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nf 4 3 2 1\nf 5 6 7 8\nf 1 2 6 "
               "5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  for (const char* input : {"ball.off", "box.obj"}) {
    const auto r = folder.shell("ulimit -s 128; '" + command_path() + "' " + input + " out.ply" + kSmall);
    INFO(input << ": " << r.err);
    CHECK(r.status == 0);
  }
}

TEST_CASE("hostile: where the system gives no threads, that is said", "[cli][hostile]") {
  Folder folder;
  folder.write_off("ball.off", ball_at({0, 0, 0}, 1));
  fs::permissions(folder / "", fs::perms::all);
  // Limits of processes do not hold for the superuser.
  const std::string other = geteuid() == 0 ? "setpriv --reuid=65534 --regid=65534 --clear-groups " : "";
  if (folder.shell(other + "'" + command_path() + "' --version").status != 0) return;
  for (const char* most : {"1", "2"}) {
    const auto r = folder.shell(other + "bash -c \"ulimit -u " + most + "; exec '" + command_path() +
                                "' ball.off out.ply" + kSmall + "\"");
    INFO(r.err);
    CHECK(r.status == 7);
    CHECK(contains(r.err, "the system gives no more threads"));
    CHECK(contains(r.err, "ulimit -u"));
    CHECK(!folder.has("out.ply"));
  }
}

TEST_CASE("hostile: buffers of glTF outside of its folder are refused, though a link leads there", "[cli][hostile]") {
  Folder folder;
  fs::create_directories(folder / "in/below");
  folder.write("a.bin", std::string(36, '\0'));
  folder.write("in/below/a.bin", std::string(36, '\0'));
  fs::create_symlink("../a.bin", folder / "in/link.bin");
  fs::create_symlink("..", folder / "in/up");
  fs::create_symlink("below/a.bin", folder / "in/stays.bin");
  const auto gltf_of = [](const std::string& uri) {
    return R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":")" + uri +
           R"("}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,)"
           R"("count":3,"type":"VEC3"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  };
  for (const std::string uri : {"link.bin", "up/a.bin"}) {
    folder.write("in/part.gltf", gltf_of(uri));
    const auto r = folder.run("in/part.gltf out.ply" + kSmall);
    INFO(r.err);
    CHECK(r.status == 3);
    CHECK(contains(r.err, "buffers[0].uri names in/" + uri + ", which leads by a link to " +
                              fs::canonical(folder / "a.bin").string()));
  }
  for (const std::string uri : {"below/a.bin", "stays.bin"}) {
    folder.write("in/part.gltf", gltf_of(uri));
    CHECK(folder.run("in/part.gltf out.ply" + kSmall).status == 5);  // it is read, and has no area
  }
}
