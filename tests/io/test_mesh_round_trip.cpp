// What is written comes back: each format, to the bit where the format can hold it.
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include "io/bytes/output_file.h"
#include "io/mesh/precision.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

// Positions with every bit in use, some of them tiny, huge or negative zero.
TriangleMesh rough_torus() {
  TriangleMesh mesh = mesh_of(shapes::torus(3, 1, 100, 60));
  uint64_t i = 0;
  for (WorldPoint& p : mesh.vertices) {
    p.x += double(random_bits(1, i++) >> 11) * 0x1p-60;
    p.z *= 1e-7;
  }
  mesh.vertices[1] = {1e300, -2e-300, -0.0};
  mesh.vertices[2] = {5e-324, 0.1, 1.0 / 3};
  return mesh;
}

// Stands in for a standard stream as long as it lives.
class StreamInstead {
 public:
  StreamInstead(int stream, const std::string& path) : stream_(stream), kept_(dup(stream)) {
    const int file = open(path.c_str(), O_RDWR | O_CREAT, 0600);
    dup2(file, stream);
    close(file);
  }
  ~StreamInstead() {
    dup2(kept_, stream_);
    close(kept_);
  }

 private:
  int stream_, kept_;
};

void round_to_float(TriangleMesh& mesh) {
  for (WorldPoint& p : mesh.vertices) p = {double(float(p.x)), double(float(p.y)), double(float(p.z))};
}

void check_same(const TriangleSoup& soup, const TriangleMesh& mesh) {
  REQUIRE(soup.vertices.size() == mesh.vertices.size());
  int64_t differences = 0;
  for (size_t i = 0; i < mesh.vertices.size(); ++i) differences += !same_bits(soup.vertices[i], mesh.vertices[i]);
  CHECK(differences == 0);
  CHECK(soup.triangles == mesh.triangles);
  CHECK(soup.faces_in_file == int64_t(mesh.triangles.size()));
  CHECK(soup.dirt.unreferenced_vertices == 0);
}

}  // namespace

TEST_CASE("mesh files: OBJ, OFF and PLY bring every bit of a double back", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const TriangleMesh mesh = rough_torus();
  for (const char* name : {"a.obj", "a.off", "a.ply"}) {
    INFO(name);
    write_mesh(folder / name, mesh);
    check_same(read_mesh(folder / name), mesh);
  }
}

TEST_CASE("mesh files: PLY is single precision exactly while no vertex moves a thousandth of a triangle's least height",
          "[mesh_file][unit]") {
  const TemporaryFolder folder;
  TriangleMesh mesh = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  mesh.vertices[0].x = 1e-9;
  CHECK_FALSE(needs_double(mesh));
  write_mesh(folder / "float.ply", mesh);
  CHECK(get_file(folder / "float.ply").find("property float x") != std::string::npos);
  for (WorldPoint& p : mesh.vertices) p.x += 1e5 + 0.1;  // single precision steps by 1/128 there
  CHECK(needs_double(mesh));
  write_mesh(folder / "double.ply", mesh);
  CHECK(get_file(folder / "double.ply").find("property double x") != std::string::npos);
  check_same(read_mesh(folder / "double.ply"), mesh);
  round_to_float(mesh);
  CHECK_FALSE(needs_double(mesh));
  TriangleMesh thin = mesh_of(shapes::box({.1, .1, .1}, {1.1, 1.1, 1.1}));
  thin.vertices.push_back({.6, .6, 1.1});
  thin.triangles.push_back({4, 7, 8});  // on a diagonal but for its rounding
  thin.vertices[8].x += 1e-3;
  CHECK_FALSE(needs_double(thin));
  thin.vertices[8].x -= .999e-3;  // edges are as long as before
  CHECK(needs_double(thin));
  write_mesh(folder / "exact.ply", mesh);
  check_same(read_mesh(folder / "exact.ply"), mesh);
}

TEST_CASE("mesh files: PLY is double where single precision makes triangles intersect that have room otherwise",
          "[mesh_file][unit]") {
  TriangleMesh mesh;
  mesh.vertices = {{-1, -1, 1}, {1, -1, 1}, {0, 1, 1}, {0, 0, 1 + 4e-8}, {2e-4, 0, 1.5}, {0, 2e-4, 1.5}};
  mesh.triangles = {{0, 1, 2}, {3, 4, 5}};
  CHECK(needs_double(mesh));  // in single precision the second one stands on the first one
  mesh.vertices[3].z = 1 + 4e-7;
  CHECK_FALSE(needs_double(mesh));
}

TEST_CASE("mesh files: binary STL brings single precision corners back, welded", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  TriangleMesh mesh = mesh_of(shapes::torus(3, 1, 150, 80));
  round_to_float(mesh);
  write_mesh(folder / "a.stl", mesh);
  CHECK(get_file(folder / "a.stl").size() == 84 + 50 * mesh.triangles.size());
  const TriangleSoup soup = read_mesh(folder / "a.stl");
  REQUIRE(soup.triangles.size() == mesh.triangles.size());
  CHECK(soup.vertices.size() == mesh.vertices.size());
  int64_t differences = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t i = 0; i < 3; ++i)
      differences += !same_bits(soup.vertices[soup.triangles[t][i]], mesh.vertices[mesh.triangles[t][i]]);
  CHECK(differences == 0);
  // Vertices stand in the order of their first corner.
  uint32_t next = 0;
  for (const auto& t : soup.triangles)
    for (const uint32_t corner : t) {
      CHECK((corner <= next));
      next = std::max(next, corner + 1);
    }
}

TEST_CASE("mesh files: an existing file is replaced only when asked, and keeps its mode", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const TriangleMesh mesh = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  put_file(folder / "a.obj", "old");
  chmod((folder / "a.obj").c_str(), 0640);
  const Error refused = error_of([&] { write_mesh(folder / "a.obj", mesh); });
  CHECK(refused.code() == ErrorCode::unwritable_output);
  CHECK(says(refused, "exists already"));
  CHECK(get_file(folder / "a.obj") == "old");
  write_mesh(folder / "a.obj", mesh, {"", true});
  CHECK(get_file(folder / "a.obj").substr(0, 2) == "v ");
  struct stat info;
  REQUIRE(stat((folder / "a.obj").c_str(), &info) == 0);
  CHECK((info.st_mode & 0777) == 0640);
  CHECK(folder.file_count() == 1);
}

TEST_CASE("mesh files: a symbolic link stays one and its target is replaced", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  put_file(folder / "target.off", "old");
  std::filesystem::create_symlink(folder / "target.off", folder / "link.off");
  write_mesh(folder / "link.off", mesh_of(shapes::box({0, 0, 0}, {1, 1, 1})), {"", true});
  CHECK(std::filesystem::is_symlink(folder / "link.off"));
  CHECK(get_file(folder / "target.off").substr(0, 3) == "OFF");
}

TEST_CASE("mesh files: what cannot be written is refused and leaves nothing behind", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const TriangleMesh mesh = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  const Error absent = error_of([&] { write_mesh(folder / "no/such/a.ply", mesh); });
  CHECK(absent.code() == ErrorCode::unwritable_output);
  CHECK(says(absent, "no/such/a.ply"));
  std::filesystem::create_directory(folder / "b.ply");
  CHECK(error_of([&] { write_mesh(folder / "b.ply", mesh, {"", true}); }).code() == ErrorCode::unwritable_output);
  CHECK(error_of([&] { write_mesh(folder / "a.dae", mesh); }).code() == ErrorCode::usage);
  CHECK(error_of([&] { write_mesh("-", mesh); }).code() == ErrorCode::usage);
  CHECK(folder.file_count() == 1);
  if (std::filesystem::exists("/dev/full")) {
    const Error full = error_of([&] { write_mesh("/dev/full", mesh, {"ply", true}); });
    CHECK(full.code() == ErrorCode::unwritable_output);
    CHECK(std::filesystem::is_character_file("/dev/full"));
  }
}

TEST_CASE("output file: without commit the old file stays and the temporary goes", "[output_file][unit]") {
  const TemporaryFolder folder;
  put_file(folder / "a", "old");
  {
    OutputFile file(folder / "a", true);
    file.write("new");
    CHECK(folder.file_count() == 2);
  }
  CHECK(folder.file_count() == 1);
  CHECK(get_file(folder / "a") == "old");
  OutputFile late(folder / "b", false);
  late.write("late");
  put_file(folder / "b", "someone was faster");
  CHECK(error_of([&] { late.commit(); }).code() == ErrorCode::unwritable_output);
  CHECK(get_file(folder / "b") == "someone was faster");
}

TEST_CASE("mesh files: - is standard output and standard input", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const TriangleMesh mesh = rough_torus();
  {
    const StreamInstead out(STDOUT_FILENO, folder / "stream");
    write_mesh("-", mesh, {"ply", false});
  }
  const StreamInstead in(STDIN_FILENO, folder / "stream");
  check_same(read_mesh("-", "ply"), mesh);
}

TEST_CASE("mesh files: when there is no room, the old file stays and the temporary goes", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  put_file(folder / "a.off", "old");
  rlimit before;
  getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = signal(SIGXFSZ, SIG_IGN);
  const rlimit small = {10000, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &small);
  std::string what;
  ErrorCode code = ErrorCode::internal;
  try {
    write_mesh(folder / "a.off", rough_torus(), {"", true});
  } catch (const Error& error) {
    what = error.what();
    code = error.code();
  }
  setrlimit(RLIMIT_FSIZE, &before);
  signal(SIGXFSZ, handler);
  CHECK(code == ErrorCode::unwritable_output);
  CHECK(what.find("what stood there is untouched") != std::string::npos);
  CHECK(get_file(folder / "a.off") == "old");
  CHECK(folder.file_count() == 1);
}
