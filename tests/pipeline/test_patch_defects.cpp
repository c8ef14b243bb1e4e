// Where the triangles of patches are no surface, on meshes of a few triangles.
#include "pipeline/defects/patch_defects.h"
#include "support/catch.h"
#include "support/soup_sheet.h"

using namespace isoshell;

namespace {

/// Vertices stand in a row, vertex v at x = v. The first ones are fixed; `joined` says which are copies.
SeededMesh made_of(uint32_t vertices, const std::vector<TriangleIndices>& triangles,
                   const std::vector<uint32_t>& joined = {}) {
  std::vector<PointQ8> position;
  for (uint32_t v = 0; v < vertices; ++v) position.push_back({int32_t(v), 0, 0});
  SeededMesh made;
  made.mesh = {to_buffer(position), to_buffer(triangles)};
  made.seeds.position = to_buffer(position);
  made.seeds.fixed.count = int64_t(joined.size());
  made.seeds.fixed.joined = to_buffer(joined);
  return made;
}
const std::vector<TriangleIndices> kTetrahedron{{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
using Wrong = std::vector<uint32_t>;

}  // namespace

TEST_CASE("patch defects: closed meshes and patches that share a border have none", "[features][unit]") {
  CHECK(find_patch_defects(made_of(4, kTetrahedron)).empty());
  const std::vector<TriangleIndices> both{{0, 1, 6}, {1, 2, 6}, {0, 6, 2}, {3, 5, 7}, {4, 7, 5}, {3, 7, 4}};
  CHECK(find_patch_defects(made_of(8, both, {0, 1, 2, 0, 1, 2})).empty());
}

TEST_CASE("patch defects: an edge of three triangles, a vertex of two fans and one of none", "[features][unit]") {
  auto with_fin = kTetrahedron;
  with_fin.push_back({0, 1, 4});
  CHECK(find_patch_defects(made_of(5, with_fin)) == Wrong{0, 1, 4});  // and one on a border that is not fixed
  auto touching = kTetrahedron;
  for (const TriangleIndices& t : std::vector<TriangleIndices>{{0, 5, 4}, {0, 4, 6}, {4, 5, 6}, {0, 6, 5}})
    touching.push_back(t);
  CHECK(find_patch_defects(made_of(7, touching)) == Wrong{0});
  CHECK(find_patch_defects(made_of(5, kTetrahedron)) == Wrong{4});
}

TEST_CASE("patch defects: an edge inside of a patch that another patch has, too", "[features][unit]") {
  // Two squares over the corners 0 to 3 and their copies 4 to 7, both cut from 0 to 2.
  const std::vector<TriangleIndices> squares{{0, 1, 2}, {0, 2, 3}, {4, 6, 5}, {4, 7, 6}};
  CHECK(find_patch_defects(made_of(8, squares, {0, 1, 2, 3, 0, 5, 2, 7})) == Wrong{0, 2, 4, 6});
  const std::vector<TriangleIndices> crossed{{0, 1, 2}, {0, 2, 3}, {4, 7, 5}, {5, 7, 6}};
  CHECK(find_patch_defects(made_of(8, crossed, {0, 1, 2, 3, 0, 1, 2, 3})).empty());
}

TEST_CASE("patch defects: two faces with the same corners bound nothing", "[features][unit]") {
  const std::vector<TriangleIndices> pillow{{0, 1, 2}, {3, 5, 4}};
  CHECK(find_patch_defects(made_of(6, pillow, {0, 1, 2, 0, 1, 2})) == Wrong{0, 1, 2, 3, 4, 5});
}
