// Files that lie are refused with a place and a reason; dirty geometry is dropped and counted.
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/source_folder.h"

using namespace isoshell;

namespace {

TriangleSoup read_malformed(const std::string& name) {
  return read_mesh(source_folder() + "/tests/data/malformed/" + name);
}

Error refusal_of(const std::string& name) {
  return error_of([&] { read_malformed(name); });
}

}  // namespace

TEST_CASE("malformed: counts that the file cannot hold are refused before memory is asked for", "[mesh_file][unit]") {
  const Error error = refusal_of("assimp_OutOfMemory.off");
  CHECK(error.code() == ErrorCode::unreadable_input);
  CHECK(says(error, "line 2: the header promises 353535235358 vertices and 6 faces; the 289 bytes"));
}

TEST_CASE("malformed: a PLY header without end_header is refused", "[mesh_file][unit]") {
  const Error error = refusal_of("assimp_crash-30d6d0f7c529b3b66b4131700b7a4580cd7082df.ply");
  CHECK(error.code() == ErrorCode::unreadable_input);
  CHECK(says(error, "no end_header within 159 bytes"));
}

TEST_CASE("malformed: an OBJ face that names absent vertices is refused with its line", "[mesh_file][unit]") {
  const Error error = refusal_of("assimp_malformed.obj");
  CHECK(error.code() == ErrorCode::unreadable_input);
  CHECK(says(error, "line 23: a face names vertex 12; the file holds vertices 1 to 8"));
}

TEST_CASE("malformed: index 0 in an OBJ file is refused with its line", "[mesh_file][unit]") {
  const Error error = refusal_of("tinyobj_issue-140-zero-face-idx.obj");
  CHECK(error.code() == ErrorCode::unreadable_input);
  CHECK(says(error, "line 16: a face names vertex 0; the file holds vertices 1 to 4"));
}

TEST_CASE("malformed: an OFF file with fewer rows than its counts is refused", "[mesh_file][unit]") {
  const Error error = refusal_of("assimp_invalid.off");
  CHECK(error.code() == ErrorCode::unreadable_input);
  CHECK(says(error, "3 vertices and 4 faces, a row each; the file holds 6 rows"));
}

TEST_CASE("malformed: sound files without a triangle are nothing to mesh", "[mesh_file][unit]") {
  for (const char* name : {"assimp_empty.obj", "tinyobj_invalid-face-definition.obj", "trimesh_stl_empty_bin.stl",
                           "trimesh_ply_empty_header.ply"}) {
    INFO(name);
    CHECK(refusal_of(name).code() == ErrorCode::nothing_to_mesh);
  }
  CHECK(says(refusal_of("tinyobj_invalid-face-definition.obj"), "2 with fewer than three corners"));
}

TEST_CASE("malformed: NaN and infinite vertices are counted and only their faces are dropped", "[mesh_file][unit]") {
  const TriangleSoup soup = read_malformed("tinyobj_test-nan.obj");
  CHECK(soup.dirt.nonfinite_vertices == 4);
  CHECK(soup.dirt.dropped_faces_nonfinite == 1);
  CHECK(soup.faces_in_file == 18);
  CHECK(soup.triangles.size() == 34);
}

TEST_CASE("malformed: a face of two corners is counted, the triangle beside it is kept", "[mesh_file][unit]") {
  const TriangleSoup soup = read_malformed("trimesh_notenoughindices.obj");
  CHECK(soup.dirt.short_faces == 1);
  CHECK(soup.triangles == std::vector<std::array<uint32_t, 3>>{{0, 1, 2}});
}
