// Files of lines: what they hold, and how those that lie are refused.
#include "isoshell/io/polyline_file.h"
#include "support/mesh_files.h"
#include "support/refusals.h"

using namespace isoshell;

namespace {

Polylines read_as(const std::string& ending, const std::string& bytes) {
  const TemporaryFolder folder;
  const std::string path = folder / ("lines." + ending);
  put_file(path, bytes);
  return *read_polylines(path);
}

Error refusal_of(const std::string& ending, const std::string& bytes) {
  return error_of([&] { read_as(ending, bytes); });
}

const std::string kPlyHeader =
    "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
    "element edge 2\nproperty int vertex1\nproperty int vertex2\nend_header\n0 0 0\n1 0 0\n1 1 0\n";

using Segments = std::vector<std::array<uint32_t, 2>>;

}  // namespace

TEST_CASE("polylines: the lines of an OBJ file are segments that know their line", "[polylines][unit]") {
  const Polylines lines = read_as("obj",
                                  "# marks\nv 0 0 0\nv 1 0 0\nv 1 1 0\nl 1 2 3\nv 0 1 0\nf 1 2 3\n"
                                  "l 3/1 -1 \\\n 1\nl 1 2\nl 2 2\n");
  CHECK(lines.points.size() == 4);
  CHECK(lines.segments == Segments{{0, 1}, {1, 2}, {2, 3}, {3, 0}});
  CHECK(lines.lines == std::vector<int64_t>{5, 5, 8, 8});
  CHECK(lines.name_of(2) == lines.source + ", line 8");
}

TEST_CASE("polylines: the edges of a PLY file are segments, in text and binary", "[polylines][unit]") {
  const Polylines lines = read_as("ply", kPlyHeader + "0 1\n2 1\n");
  CHECK(lines.segments == Segments{{0, 1}, {2, 1}});
  CHECK(lines.points[2].y == 1);
  CHECK(lines.name_of(1) == lines.source + ", segment 1");

  const TemporaryFolder folder;
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {{{0, 2, 1}}, {{0, 1, 3}}, {{1, 2, 3}}, {{0, 3, 2}}}};
  mesh.features.curve_edges = {{{0, 3}, 0}, {{1, 2}, 1}};
  write_mesh(folder / "mesh.ply", mesh, {"ply", false, true});
  const auto written = read_polylines(folder / "mesh.ply");
  CHECK(written->segments == Segments{{0, 3}, {1, 2}});
  CHECK(written->points.size() == 4);
  CHECK(read_mesh(folder / "mesh.ply").triangles.size() == 4);
  write_mesh(folder / "plain.ply", mesh);
  CHECK(says(error_of([&] { read_polylines(folder / "plain.ply"); }), "holds no edges"));
}

TEST_CASE("polylines: files that lie are refused with their place", "[polylines][unit]") {
  const Error far = refusal_of("obj", "v 0 0 0\nv 1 0 0\nl 1 3\n");
  CHECK(far.code() == ErrorCode::unreadable_input);
  CHECK(says(far, "line 3: a line names vertex 3; the file holds vertices 1 to 2"));
  CHECK(says(refusal_of("obj", "v 0 0 0\nv 1 0 0\nl 0 1\n"), "line 3: a line names vertex 0"));
  CHECK(says(refusal_of("obj", "v 0 0 0\nv 1 0 0\nl 1 -3\n"), "line 3: a line names vertex -3"));
  CHECK(says(refusal_of("obj", "v 0 0 0\nv 1 0 0\nl 1 two\n"), "line 3: a line names the vertex 'two'"));
  CHECK(says(refusal_of("obj", "v 0 0 0\nv 1 0 0\nl 1\n"), "line 3: a line has fewer than two vertices"));
  CHECK(says(refusal_of("obj", "v 0 0 nan\nv 1 0 0\nl 1 2\n"), "line 1: a vertex needs three finite numbers"));
  CHECK(says(refusal_of("obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"), "holds no line of two vertices"));
  CHECK(says(refusal_of("obj", ""), "holds no line"));
  CHECK(says(refusal_of("ply", kPlyHeader + "0 1\n2 3\n"), "edge 1 names vertex 3; the file holds vertices 0 to 2"));
  CHECK(says(refusal_of("ply", kPlyHeader + "0 1\n"), "line 7: element edge promises 2 rows of at least 4 bytes"));
  CHECK(says(refusal_of("ply",
                        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                        "property float z\nelement edge 1\nproperty int from\nend_header\n0 0 0\n0\n"),
             "element edge has no number named vertex1"));
  const Error other = error_of([] { read_polylines("lines.stl"); });
  CHECK(other.code() == ErrorCode::usage);
  CHECK(error_of([] { read_polylines("/nowhere/lines.obj"); }).code() == ErrorCode::unreadable_input);
}
