// Patches that cannot be relaxed are simplified instead.
#include <array>
#include <vector>

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

/// Teeth 1 wide and 8 high side by side, with slots between them that are `slot` wide at the top and nothing below.
TriangleSoup comb(int teeth, double slot) {
  std::vector<std::array<double, 2>> top;
  for (int i = 0; i < teeth; ++i) {
    top.push_back({double(i), 8});
    top.push_back({i + 1 - slot, 8});
    if (i + 1 < teeth) top.push_back({i + 1 - slot / 2, 1});
  }
  const auto m = uint32_t(top.size());
  TriangleSoup soup;
  for (const double z : {0., 10.})
    for (const auto& [x, y] : top) soup.vertices.push_back({x, y, z});
  for (const double z : {0., 10.})
    for (const auto& [x, y] : top) soup.vertices.push_back({x, 0, z});
  const uint32_t base = 2 * m;
  const auto quad = [&](uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    soup.triangles.insert(soup.triangles.end(), {{a, b, c}, {a, c, d}});
  };
  for (uint32_t i = 0; i + 1 < m; ++i) {
    quad(i, m + i, m + i + 1, i + 1);
    quad(base + i, base + i + 1, base + m + i + 1, base + m + i);
    quad(base + i, i, i + 1, base + i + 1);
    quad(base + m + i, base + m + i + 1, m + i + 1, m + i);
  }
  quad(0, base, base + m, m);
  quad(m - 1, 2 * m - 1, base + 2 * m - 1, base + m - 1);
  return soup;
}

}  // namespace

TEST_CASE("slots that narrow to nothing keep their creases", "[features]") {
  RemeshOptions options;
  options.vertices = 1200;
  TestContext context;
  const TriangleSoup part = comb(4, 1e-3);  // ten steps of the lattice at the top
  const RemeshResult result = remesh(part, options, context);
  CHECK(int64_t(result.mesh.vertices.size()) == options.vertices);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(result.report.features.kept_length_world > .999 * result.report.features.length_world);
  CHECK(result.report.features.on_sheet.empty());
}

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
  for (const int64_t vertices : {250, 300, 400}) {
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
    CHECK(result.report.sheet.topology.genus == 16);
  }
  options.vertices = 100;  // no room for so many
  TestContext context;
  const RemeshResult coarse = remesh(part, options, context);
  CHECK(check_mesh(coarse.mesh).is_closed_manifold());
  CHECK(coarse.report.optimize.self_intersections == 0);
}
