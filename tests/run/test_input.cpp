// Every kind of input through one call: what it is, what is known of it, what is said about it.
#include <limits>

#include "isoshell/error.h"
#include "isoshell/io/input.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

TriangleMesh ball_mesh() {
  const TriangleSoup ball = shapes::sphere({1, 2, 3}, 5, 24);
  return {ball.vertices, ball.triangles};
}

std::string rows_of_points(const TriangleMesh& mesh) {
  std::string rows;
  for (const WorldPoint& p : mesh.vertices)
    rows += std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  return rows;
}

/// What was said while it was read.
struct Said {
  std::string notes, warnings;

  Tell tell() {
    return [this](MessageKind kind, const std::string& text) {
      (kind == MessageKind::warning ? warnings : notes) += text + "\n";
    };
  }
};

ErrorCode refusal_code(const InputRequest& request) {
  return error_of([&] { read_input(request, 0); }).code();
}

}  // namespace

TEST_CASE("input: meshes of every format are read with their counts and their box", "[input]") {
  const TemporaryFolder folder;
  const TriangleMesh ball = ball_mesh();
  for (const char* format : {"ply", "obj", "stl", "off"}) {
    const std::string path = folder / (std::string("ball.") + format);
    write_mesh(path, ball);
    Said said;
    const Input input = read_input({path, "", "", {}}, 0, said.tell());
    CHECK(input.facts.kind == InputKind::mesh);
    CHECK(input.facts.path == path);
    CHECK(input.facts.faces == int64_t(ball.triangles.size()));
    CHECK(input.soup.triangles.size() == ball.triangles.size());
    CHECK(input.facts.box_min->z == Approx(-2));
    CHECK(input.facts.box_max->z == Approx(8));
    CHECK_FALSE(input.stage);
    CHECK(contains(said.notes, path + ": "));
    CHECK(contains(said.notes, " faces"));
    CHECK(said.warnings.empty());
  }
}

TEST_CASE("input: points become a surface, whatever file they are in", "[input]") {
  const TemporaryFolder folder;
  const TriangleMesh ball = ball_mesh();
  const std::string count = std::to_string(ball.vertices.size()), rows = rows_of_points(ball);
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex " + count + "\nproperty float x\nproperty float y\nproperty float z\n";
  put_file(folder / "a.xyz", rows);
  put_file(folder / "a.pcd", "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH " + count +
                                 "\nHEIGHT 1\nPOINTS " + count + "\nDATA ascii\n" + rows);
  put_file(folder / "a.ply", ply + "end_header\n" + rows);
  put_file(folder / "b.ply",
           ply + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + rows + "3 0 0 0\n");
  for (const char* name : {"a.xyz", "a.pcd", "a.ply", "b.ply"}) {
    Said said;
    const Input input = read_input({folder / name, "", "", {}}, 0, said.tell());
    CHECK(input.facts.kind == InputKind::points);
    CHECK(input.facts.vertices == int64_t(ball.vertices.size()));
    CHECK(input.facts.faces == 0);
    CHECK_FALSE(input.soup.triangles.empty());
    CHECK(contains(said.notes, "normals estimated"));
    CHECK(contains(said.warnings, "it is read as a point cloud") == (std::string(name) == "b.ply"));
  }
  PointCloud cloud;
  cloud.position = ball.vertices;
  CHECK(input_of(cloud, "points of mine", 0).facts.vertices == int64_t(ball.vertices.size()));
}

TEST_CASE("input: surfaces in memory are called as the caller names them", "[input]") {
  Said said;
  const Input input = input_of(shapes::sphere({0, 0, 0}, 1, 16), "ball of mine", said.tell());
  CHECK(input.facts.name() == "ball of mine");
  CHECK(contains(said.notes, "ball of mine: "));
  CHECK(input.facts.box_max->x == Approx(1).margin(0.05));
  CHECK_THROWS_AS(input_of(TriangleSoup{}, "nothing"), Error);
}

TEST_CASE("input: a surface made in memory has as many faces as triangles", "[input]") {
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 16);
  ball.faces_in_file = 0;
  Said said;
  const int64_t triangles = int64_t(ball.triangles.size());
  const Input input = input_of(std::move(ball), "ball", said.tell());
  CHECK(input.facts.faces == triangles);
  CHECK_FALSE(contains(said.notes, " 0 faces"));
}

TEST_CASE("input: a surface in memory with a vertex that is not there or not finite is refused by its place",
          "[input]") {
  const auto refusal = [](const TriangleSoup& soup) {
    return message_of(ErrorCode::unreadable_input, [&] { input_of(soup, "mine"); });
  };
  TriangleSoup soup;
  soup.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}};
  CHECK(refusal(soup) ==
        "mine: triangle 1 has vertex 3 of a surface of 3 vertices; indices count from 0 and are below that");
  soup.vertices.push_back({0, 0, std::numeric_limits<double>::infinity()});
  CHECK(refusal(soup) == "mine: triangle 1 has vertex 3 at (0, 0, inf); positions must be finite");
  soup.triangles.pop_back();
  CHECK(refusal(soup).empty());
}

TEST_CASE("input: names may hold a grid, formats come in any writing", "[input]") {
  const InputRequest grid = named_input("dir.vdb:x/smoke.vdb:density");
  CHECK(grid.path == "dir.vdb:x/smoke.vdb");
  CHECK(grid.grid == "density");
  CHECK(grid.format == "vdb");
  CHECK(named_input("a.nvdb:x[1]").grid == "x[1]");
  CHECK(named_input("dir.x/a.OBJ").format == "obj");
  CHECK(named_input("-", ".STL").format == "stl");
  CHECK(named_input("scan", "PLY").format == "ply");
  CHECK_THROWS_AS(named_input("-"), Error);
  CHECK_THROWS_AS(named_input("smoke.vdb:"), Error);
}

TEST_CASE("input: what cannot be read is refused with what it is", "[input]") {
  const TemporaryFolder folder;
  write_mesh(folder / "ball.ply", ball_mesh());
  CHECK(refusal_code({folder / "none.ply", "", "", {}}) == ErrorCode::unreadable_input);
  CHECK(refusal_code({folder / "", "", "", {}}) == ErrorCode::unreadable_input);
  CHECK(refusal_code({folder / "ball.ply", "fbx", "", {}}) == ErrorCode::unreadable_input);
  CHECK(refusal_code({folder / "ball.ply", "", "", 0.5}) == ErrorCode::usage);
}
