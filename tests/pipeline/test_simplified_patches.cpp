// Patches that cannot be relaxed are simplified instead.
#include "golden/golden_inputs.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

TriangleSoup soup_of(const TriangleMesh& mesh) {
  TriangleSoup soup;
  soup.vertices = mesh.vertices;
  soup.triangles = mesh.triangles;
  return soup;
}

}  // namespace

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

TEST_CASE("a part whose handles are narrower than edges keeps them all, and its volume", "[features]") {
  const TriangleSoup part = shapes::sieve(4, 3, 1, 2);  // 16 holes between bars of one unit
  RemeshOptions options;
  for (const int64_t vertices : {250, 400}) {
    INFO(vertices << " vertices");
    options.vertices = vertices;
    TestContext context;
    const RemeshResult result = remesh(part, options, context);
    CHECK(int64_t(result.mesh.vertices.size()) == vertices);
    const MeshTopology topology = check_mesh(result.mesh);
    CHECK(topology.is_closed_manifold());
    CHECK(topology.genus == 16);
    CHECK(result.report.optimize.self_intersections == 0);
    CHECK(std::abs(volume(soup_of(result.mesh)) / volume(part) - 1) < .01);
    CHECK(result.report.features.kept);
  }
  options.vertices = 100;  // no room for so many
  TestContext context;
  const RemeshResult coarse = remesh(part, options, context);
  CHECK(check_mesh(coarse.mesh).is_closed_manifold());
  CHECK(coarse.report.optimize.self_intersections == 0);
}
