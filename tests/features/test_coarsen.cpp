// Fine triangles of cut surfaces, with fewer vertices.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "features/shape_cuts.h"
#include "features/walls/coarsen_walls.h"
#include "features/walls/collapse_crossings.h"
#include "support/catch.h"
#include "support/test_context.h"

using namespace isoshell;
using namespace isoshell::shape_cuts;

namespace {

/// Two square sheets of 6 that leave a common edge at an angle of .04 degrees, where the upper one is parted in two.
FeatureShape sheets_nearer_than_a_step() {
  FeatureMesh mesh;
  constexpr double kHeight = 4e-3;
  mesh.vertices = {{0, 0, 0}, {0, 6, 0}, {6, 0, 0}, {6, 6, 0}, {6, 0, kHeight}, {6, 2, kHeight}, {6, 6, kHeight}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}, {0, 4, 5}, {0, 5, 1}, {1, 5, 6}};
  mesh.source_face = {0, 1, 2, 3, 4};
  return {"sheets", mesh, network_of(mesh, {{0, 1}}), 2, 2};
}

size_t pairs_that_meet(const WallMesh& mesh) {
  size_t pairs = 0;
  for (uint32_t t = 0; t < mesh.triangles().size(); ++t)
    if (!mesh.triangles()[t].is_gone()) mesh.for_each_met(t, [&](uint32_t other) { pairs += other > t; });
  return pairs;
}

}  // namespace

TEST_CASE("fine triangles that meet once they are rounded are collapsed until none does", "[features]") {
  TestContext context;
  const FeatureShape sheets = sheets_nearer_than_a_step();
  const CutSurface cut = cut_of(sheets);
  WallMesh mesh(cut, all_triangles_of(cut));
  const int64_t before = mesh.vertex_count();
  CHECK(pairs_that_meet(mesh) > 20);
  collapse_crossings(mesh, context);
  CHECK(pairs_that_meet(mesh) == 0);
  CHECK(mesh.vertex_count() > before / 2);
  for (const RegionTriangle& t : mesh.triangles())
    if (!t.is_gone()) CHECK(mesh.lookup().cosine(mesh, t) > 0);
}

TEST_CASE("narrow facets of a cylinder are collapsed to even triangles with the vertices asked for", "[features]") {
  TestContext context;
  for (const uint32_t around : {40, 150, 400}) {
    INFO(around << " facets");
    FeatureShape cylinder = feature_cylinder(around);
    cylinder.mesh.source_face.resize(cylinder.mesh.triangles.size());
    std::iota(cylinder.mesh.source_face.begin(), cylinder.mesh.source_face.end(), 0u);
    const CutSurface cut = cut_of(cylinder);
    WallMesh made(cut, all_triangles_of(cut));
    coarsen_walls(made, 150, context);
    CHECK(made.vertex_count() == 150);
    double shortest = 1e30, longest = 0, narrowest = 1;
    for (const RegionTriangle& t : made.triangles()) {
      if (t.is_gone()) continue;
      narrowest = std::min(narrowest, made.sine(t));
      for (size_t i = 0; i < 3; ++i) {
        const double edge = length(made.at(t.corner[(i + 1) % 3]) - made.at(t.corner[i]));
        shortest = std::min(shortest, edge);
        longest = std::max(longest, edge);
      }
    }
    CHECK(longest < 3 * shortest);
    CHECK(narrowest > std::sin(25 * 3.14159265 / 180));
  }
}
