// Fine triangles of cut surfaces, with fewer vertices.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "features/shape_cuts.h"
#include "features/walls/coarsen_walls.h"
#include "support/catch.h"
#include "support/test_context.h"

using namespace isoshell;
using namespace isoshell::shape_cuts;

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
