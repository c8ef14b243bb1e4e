// The dual on surfaces with borders and fixed seeds.
#include "cpu/relax/label_simd.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/cut_surfaces.h"
#include "support/open_meshes.h"
#include "support/test_context.h"

using namespace isoshell;

TEST_CASE("open dual: a triangulation of the surface, whose border is the polygon of fixed seeds",
          "[open_dual][dual][stage][cuda]") {
  TestContext context;
  for (const FixedCase& from : fixed_cases())
    for (const int64_t count : {0, 3, 40, 250}) {
      INFO(from.mesh.name << ", " << count << " free seeds");
      const SurfaceMesh surface = surface_of(from.mesh, context);
      SeedSet seeds = with_free_seeds(surface, fixed_on_borders(surface, from.is_seed), count);
      const SeedSet before = to_host(seeds);
      DualReport report;
      const DualMesh mesh = triangulate_dual(surface, seeds, {}, report, context);
      CHECK(report.failed_cells == 0);
      check_fixed_unchanged(before, seeds);
      check_open_mesh(surface, seeds, mesh);
      check_joined(from, join_patches(mesh, seeds.fixed).mesh);
    }
}
