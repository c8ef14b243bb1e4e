// Seeds of method shell: one a stratum, on the surface, and honest refusals. Then: onto the sheet.
#include "isoshell/advanced/digest.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/paper_setup.h"
#include "support/refusals.h"
#include "support/soup_sheet.h"
#include "support/test_context.h"
#include "voxel/closest_point.h"
#include "voxel/proxy_depth.h"

using namespace isoshell;

TEST_CASE("seeds: one site in each of k strata, placed at its sample", "[seeds][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(20), 2);
  const int64_t sites = setup.sites.voxels.voxel_count();
  const std::vector<Voxel> voxel = voxels_of(setup.sites.voxels);
  TestContext context;
  for (const int64_t k : {int64_t(4), int64_t(97), sites / 2}) {
    const SeedSet seeds = place_seeds(setup.sites, setup.samples, {k, 5}, context);
    REQUIRE(seeds.size() == k);
    for (int64_t i = 0; i < k; ++i) {
      const uint32_t home = seeds.home[i];
      // Strata differ by one site at most, so this holds for any way to cut them.
      CHECK(std::abs(double(home) + .5 - (double(i) + .5) * double(sites) / double(k)) <=
            .5 * double(sites) / double(k) + 1);
      if (i > 0) CHECK(home > seeds.home[i - 1]);
      const SiteSample& s = setup.samples.sample[home];
      const PointQ8 c = voxel_centre(voxel[home]);
      CHECK(seeds.position[i] == PointQ8{c.x + s.dx, c.y + s.dy, c.z + s.dz});
      CHECK(dot(seeds.normal[i], seeds.normal[i]) == dot(s.normal, s.normal));
    }
  }
  const uint64_t five = digest(place_seeds(setup.sites, setup.samples, {97, 5}, context));
  CHECK(five != digest(place_seeds(setup.sites, setup.samples, {97, 6}, context)));
  TestContext single;
  single.threads = 1;
  CHECK(five == digest(place_seeds(setup.sites, setup.samples, {97, 5}, single)));
}

TEST_CASE("seeds: more than half the sites is a usage error that names the resolution that would do",
          "[seeds][stage]") {
  const PaperSetup setup = paper_setup(ball_skin(20), 2);
  TestContext context;
  const int64_t most = setup.sites.voxels.voxel_count() / 2;
  for (const int64_t k : {int64_t(3), most + 1, 4 * most}) {
    const Error error = error_of([&] { place_seeds(setup.sites, setup.samples, {k, 0}, context); });
    CHECK(error.code() == ErrorCode::usage);
    // The sphere is 41 voxels wide; four times the seeds need twice that.
    if (k == 4 * most) CHECK(says(error, "at least 82"));
  }
}

TEST_CASE("seeds: attached to the sheet they sit on it, at home at the vertex that was nearest",
          "[seeds][attach][stage]") {
  // A tetrahedron of four vertices stands in for a sheet.
  Sheet sheet;
  const PointQ8 corner[4] = {{9000, 9000, 9000}, {12000, 9000, 9000}, {9000, 13000, 9000}, {9000, 9000, 11000}};
  const TriangleIndices face[4] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  std::vector<Voxel> voxels;
  for (PointQ8 p : corner) voxels.push_back(voxel_of(p));
  sheet.corners = std::move(make_site_set(voxels, {128, 128, 128}).voxels);
  cut_into_blocks(sheet.corners, sheet);
  sheet.position = Buffer<PointQ8>(4);
  sheet.normal = Buffer<Normal8>(4);
  sheet.triangles = Buffer<TriangleIndices>(4);
  sheet.vertex_first = Buffer<uint32_t>(5);
  sheet.vertex_triangles = Buffer<uint32_t>(12);
  uint32_t at = 0;
  for (uint32_t v = 0; v < 4; ++v) {
    sheet.position[v] = corner[v];
    sheet.normal[v] = {int8_t(v), 0, 127};
    sheet.triangles[v] = face[v];
    sheet.vertex_first[v] = at;
    for (uint32_t f = 0; f < 4; ++f)
      if (face[f].a == v || face[f].b == v || face[f].c == v) sheet.vertex_triangles[at++] = f;
  }
  sheet.vertex_first[4] = at;
  std::vector<PointQ8> from;
  for (uint64_t i = 0; i < 300; ++i) {
    const uint64_t r = random_bits(3, i);
    from.push_back({int32_t(8000 + r % 6000), int32_t(8000 + (r >> 20) % 6000), int32_t(8000 + (r >> 40) % 6000)});
  }
  const int halvings = GENERATE(0, 1, 2);  // seeds of coarser lattices lie at the same points of the sheet's
  SeedSet seeds = seeds_at(from);
  for (PointQ8& p : seeds.position) p = {p.x >> halvings, p.y >> halvings, p.z >> halvings};
  for (size_t i = 0; i < from.size(); ++i)
    from[i] = {seeds.position[int64_t(i)].x << halvings, seeds.position[int64_t(i)].y << halvings,
               seeds.position[int64_t(i)].z << halvings};
  if (halvings > 0)  // those of coarse proxies come from outside
    for (size_t i = 0; i < from.size(); ++i)
      from[i] = moved_by_proxy_depth(from[i], seeds.normal[int64_t(i)], kOneVoxelQ8 << halvings);
  TestContext context;
  attach_to_sheet(sheet, seeds, context, halvings);
  for (int64_t i = 0; i < seeds.size(); ++i) {
    const PointQ8 p = from[size_t(i)];
    uint32_t nearest = 0;
    for (uint32_t v = 1; v < 4; ++v)
      if (distance_sq_q16(corner[v], p) < distance_sq_q16(corner[nearest], p)) nearest = v;
    CHECK(seeds.home[i] == nearest);
    CHECK(int32_t(seeds.normal[i].x) == int32_t(nearest));
    int64_t least = INT64_MAX;
    for (const TriangleIndices& t : face)
      if (t.a == nearest || t.b == nearest || t.c == nearest)
        least =
            std::min(least, distance_sq_q16(p, closest_point_on_triangle(p, corner[t.a], corner[t.b], corner[t.c])));
    CHECK(distance_sq_q16(seeds.position[i], p) == least);
  }
}
