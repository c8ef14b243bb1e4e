// Patches that cannot be relaxed are simplified instead.
#include "golden/golden_inputs.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/test_context.h"

using namespace isoshell;

TEST_CASE("patches of a thin wall that would intersect are simplified, and keep every crease", "[features]") {
  const TriangleSoup plate = golden::bent_plate(0.5, 0.004);
  RemeshOptions options;
  for (const int64_t vertices : {60, 100}) {
    options.vertices = vertices;
    TestContext context;
    const RemeshResult result = remesh(plate, options, context);
    CHECK(result.report.features.kept);
    CHECK(result.report.features.kept_length_world == Approx(result.report.features.length_world));
    CHECK(result.report.optimize.self_intersections == 0);
    CHECK(check_mesh(result.mesh).is_closed_manifold());
    CHECK(int64_t(result.mesh.vertices.size()) <= vertices);
    CHECK(int64_t(result.mesh.vertices.size()) >= vertices - 1);
  }
}
