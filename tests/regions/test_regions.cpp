// Meshes of regions: closed, conforming, with the count that was asked for.
#include "isoshell/io/memory_input.h"
#include "isoshell/mesh_census.h"
#include "isoshell/remesh.h"
#include "regions/label_volumes.h"
#include "regions/region_oracle.h"
#include "support/refusals.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

RemeshResult meshed(const LabelVolume& volume, int64_t vertices, TestContext& context) {
  RemeshOptions options;
  options.vertices = vertices;
  return remesh(surface_of_labels(volume, "labels", 0), options, context);
}

}  // namespace

TEST_CASE("grains become one mesh of closed regions with the vertices that were asked for") {
  TestContext context;
  const LabelVolume volume = voronoi_grains(32, 12);
  const RemeshResult result = meshed(volume, 4000, context);
  const TriangleMesh& mesh = result.mesh;
  CHECK(mesh.vertices.size() == 4000);
  const std::string fault = fault_of_regions(mesh.triangles, mesh.regions);
  INFO(fault);
  CHECK(fault.empty());
  CHECK(pairs_of(mesh.regions) == pairs_of(volume));
  const MeshCensus census = take_census(mesh, context);
  CHECK(census.intersecting_pairs == 0);
  CHECK(census.shapes.q_mean > 0.88);
  for (const auto& [label, world] : volumes_of_regions(mesh.vertices, mesh.triangles, mesh.regions)) {
    const auto voxels = double(std::count(volume.labels.begin(), volume.labels.end(), label));
    INFO("region " << label << " of " << voxels << " voxels");
    CHECK(world > 0.95 * voxels);
    CHECK(world < 1.05 * voxels);
  }
}

TEST_CASE("regions have the same mesh with any number of threads") {
  const LabelVolume volume = voronoi_grains(20, 8);
  TestContext one, two;
  one.threads = 1;
  two.threads = 2;
  const TriangleMesh a = meshed(volume, 1500, one).mesh, b = meshed(volume, 1500, two).mesh;
  CHECK(a.triangles == b.triangles);
  CHECK(a.regions.labels == b.regions.labels);
}

TEST_CASE("ugly labels give valid regions, and the walls as they came in where nothing else is valid") {
  TestContext context;
  for (uint32_t number = 0; number < 200; number += 5) {
    const LabelVolume volume = random_labels(number);
    if (pairs_of(volume).empty()) continue;
    INFO("random volume " << number);
    const TriangleMesh mesh = meshed(volume, 400, context).mesh;
    const std::string fault = fault_of_regions(mesh.triangles, mesh.regions);
    INFO(fault);
    CHECK(fault.empty());
    CHECK(pairs_of(mesh.regions) == pairs_of(volume));
    CHECK(take_census(mesh, context).intersecting_pairs == 0);
  }
}

TEST_CASE("the shell method refuses regions") {
  TestContext context;
  RemeshOptions options;
  options.method = Method::shell;
  const TriangleSoup soup = surface_of_labels(voronoi_grains(8, 3), "labels", 0);
  CHECK(contains(message_of(ErrorCode::usage, [&] { remesh(soup, options, context); }), "--method shell"));
}
