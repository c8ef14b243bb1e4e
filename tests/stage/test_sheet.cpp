// build_sheet against brute force: the solid voxel by voxel, the mesh by counting.
#include <algorithm>
#include <cmath>
#include <map>

#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/sheet/project_simd.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "oracle/dense_solid.h"
#include "stages/sheet/sheet_body.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"
#include "support/voxel_sites.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

struct Pipeline {
  LatticeSurface surface;
  SiteSet sites;
  SiteSamples samples;
};

Pipeline sites_of(const TriangleSoup& soup, int32_t resolution, TestContext& context) {
  const auto [lo, hi] = bounding_box(soup);
  Pipeline p;
  p.surface = snap_surface(soup, LatticeFrame::around(lo, hi, resolution), context);
  p.sites = voxelize(p.surface, context);
  p.samples = sample_sites(p.surface, p.sites, context);
  return p;
}

Sheet sheet_of(const TriangleSoup& soup, int32_t resolution, const SheetOptions& options = {}, int threads = 0) {
  TestContext context;
  context.threads = threads;
  const Pipeline p = sites_of(soup, resolution, context);
  return build_sheet(p.surface, p.sites, p.samples, options, context);
}

/// Everything that a sheet promises whatever the input.
void check_sheet(const Sheet& sheet) {
  std::map<std::pair<uint32_t, uint32_t>, int> sides;
  int64_t defects = 0;
  for (const TriangleIndices& t : sheet.triangles) {
    const uint32_t c[3] = {t.a, t.b, t.c};
    for (int k = 0; k < 3; ++k) defects += sides[{c[k], c[(k + 1) % 3]}]++ != 0;
  }
  for (const auto& side : sides) defects += sides.count({side.first.second, side.first.first}) != 1;
  CHECK(defects == 0);
  CHECK(sheet.corners.voxel_count() == sheet.vertex_count());
  const int64_t euler = sheet.vertex_count() - int64_t(sides.size()) / 2 + sheet.triangles.size();
  CHECK(euler == 2 * (sheet.topology.components - sheet.topology.genus));
  REQUIRE(sheet.vertex_first[sheet.vertex_count()] == 3 * sheet.triangles.size());
  int64_t misplaced = 0;
  for (int64_t v = 0; v < sheet.vertex_count(); ++v)
    for (int64_t i = sheet.vertex_first[v]; i < sheet.vertex_first[v + 1]; ++i) {
      const TriangleIndices t = sheet.triangles[sheet.vertex_triangles[i]];
      misplaced += t.a != v && t.b != v && t.c != v;
      misplaced += i > sheet.vertex_first[v] && sheet.vertex_triangles[i] <= sheet.vertex_triangles[i - 1];
    }
  CHECK(misplaced == 0);
  int64_t without_normal = 0;
  for (const Normal8 n : sheet.normal) without_normal += n.x == 0 && n.y == 0 && n.z == 0;
  CHECK(without_normal == 0);
}

/// Six times the enclosed volume in voxels.
double signed_volume(const Sheet& sheet) {
  double sum = 0;
  for (const TriangleIndices& t : sheet.triangles) {
    const auto p = [&](uint32_t v) { return difference(sheet.position[v], sheet.position[0]); };
    sum += double(dot(p(t.a), cross(p(t.b), p(t.c)))) / (256.0 * 256 * 256);
  }
  return sum / 6;
}

}  // namespace

TEST_CASE("sheet: simple shapes have their components, genus and volume", "[sheet][stage]") {
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 48);
  const Sheet sphere = sheet_of(ball, 64);
  check_sheet(sphere);
  CHECK(sphere.topology.components == 1);
  CHECK(sphere.topology.genus == 0);
  CHECK(signed_volume(sphere) == Approx(4.18879 * 31.5 * 31.5 * 31.5).epsilon(0.02));

  const Sheet ring = sheet_of(shapes::torus(2, .7, 60, 30), 96);
  check_sheet(ring);
  CHECK(ring.topology.components == 1);
  CHECK(ring.topology.genus == 1);
  CHECK(signed_volume(ring) > 0);

  const TriangleSoup boxes = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({2, .1, .2}, {3, 1.2, 1}));
  const Sheet two = sheet_of(boxes, 80);
  check_sheet(two);
  CHECK(two.topology.components == 2);
  CHECK(two.topology.genus == 0);

  const Sheet walls = sheet_of(shapes::two_sheets(1, .2), 64);
  check_sheet(walls);
  CHECK(walls.topology.components == 2);
  CHECK(walls.topology.genus == 0);
  SheetOptions closing;
  closing.closing_vox = 7;
  const Sheet slab = sheet_of(shapes::two_sheets(1, .2), 64, closing);
  check_sheet(slab);
  CHECK(slab.topology.components == 1);
  CHECK(slab.topology.bridged_vertices > 0);

  const Sheet outer = sheet_of(shapes::together(ball, shapes::sphere({0, 0, 0}, .5, 24)), 64);
  CHECK(outer.topology.components == 1);
}

TEST_CASE("sheet: vertices lie on the nearest triangle of the surface", "[sheet][stage]") {
  const TriangleSoup soup = shapes::together(shapes::torus(2, .7, 40, 20), shapes::box({-.4, -.4, -.4}, {.4, .5, .3}));
  TestContext context;
  context.backend = Backend::cpu;
  const Pipeline p = sites_of(soup, 72, context);
  const Sheet sheet = build_sheet(p.surface, p.sites, p.samples, {}, context);
  check_sheet(sheet);
  CpuExecutor exec(context, "sheet");
  Solid solid = close_sites(exec, p.sites, 0);
  if (make_well_composed(exec, solid) > 0) fill_cavities(exec, solid);
  QuadMesh mesh = list_boundary(exec, solid);
  const SitedSurfaceView view = {p.surface.points.view(), p.surface.triangles.view(), p.sites.voxels.view(),
                                 p.samples.first.view(), p.samples.triangles.view()};
  const LaidMesh laid = lay_onto_surface(exec, mesh, view, false);
  int64_t wrong = 0, far = 0;
  for (int64_t v = 0; v < sheet.vertex_count(); ++v) {
    NearestTriangle best;
    for (int64_t t = 0; t < p.surface.triangles.size(); ++t) {
      const TriangleIndices c = p.surface.triangles[t];
      const PointQ8 q = closest_point_on_triangle(laid.smooth[v], p.surface.points[c.a], p.surface.points[c.b],
                                                  p.surface.points[c.c]);
      const int64_t d = distance_sq_q16(laid.smooth[v], q);
      if (d < best.distance_sq_q16) best = {d, uint32_t(t), q};
    }
    wrong += sheet.source_triangle[v] != best.triangle || sheet.position[v] != best.point;
    far += best.distance_sq_q16 > 512 * 512;
  }
  CHECK(wrong == 0);
  CHECK(far == 0);
}

TEST_CASE("sheet: points of a closed surface that it misses are known", "[sheet][stage]") {
  TriangleSoup soup = shapes::sphere({0, 0, 0}, 1, 60);
  WorldPoint& pit = soup.vertices[soup.vertices.size() / 2 + 3];
  pit = {0.8 * pit.x, 0.8 * pit.y, 0.8 * pit.z};
  TestContext context;
  Pipeline p = sites_of(soup, 60, context);
  CHECK(build_sheet(p.surface, p.sites, p.samples, {}, context).missed.empty());  // not known to be closed
  p.surface.topology.closed = p.surface.topology.oriented = true;
  const Sheet sheet = build_sheet(p.surface, p.sites, p.samples, {}, context);
  int64_t next = 0, wrong = 0;
  bool has_pit = false;
  for (const PointQ8& q : p.surface.points) {
    uint32_t near = 0;
    for (uint32_t v = 1; v < sheet.position.size(); ++v)
      if (distance_sq_q16(sheet.position[v], q) < distance_sq_q16(sheet.position[near], q)) near = v;
    int64_t off = INT64_MAX;
    for (const TriangleIndices& t : sheet.triangles)
      if (t.a == near || t.b == near || t.c == near)
        off = std::min(off, distance_sq_q16(q, closest_point_on_triangle(q, sheet.position[t.a], sheet.position[t.b],
                                                                         sheet.position[t.c])));
    if (off <= kOffSurfaceQ8 * kOffSurfaceQ8 || off > kFarOffSurfaceQ8 * kFarOffSurfaceQ8) continue;
    wrong += next >= sheet.missed.size() || sheet.missed[next] != q || sheet.missed_vertex[next] != near;
    ++next;
    has_pit |= q == p.surface.frame.snap(pit);
  }
  CHECK(next == sheet.missed.size());
  CHECK(wrong == 0);
  CHECK(has_pit);
}

TEST_CASE("sheet: neither threads nor the order of the input change a bit", "[sheet][stage]") {
  TriangleSoup soup = shapes::together(shapes::torus(2, .7, 60, 30), shapes::box({-.4, -.4, -.4}, {.4, .5, .3}));
  for (const int32_t r : {0, 3}) {
    SheetOptions options;
    options.closing_vox = r;
    const uint64_t one = digest(sheet_of(soup, 100, options, 1));
    CHECK(digest(sheet_of(soup, 100, options, 2)) == one);
    TriangleSoup shuffled = soup;
    std::reverse(shuffled.triangles.begin(), shuffled.triangles.end());
    CHECK(digest(sheet_of(shuffled, 100, options, 2)) == one);
  }
}

TEST_CASE("sheet: handles that only near parts close are cut, and true ones stay", "[sheet][stage]") {
  // Two square rings side by side, the left one slit at z = 4. The slit is thinner than a voxel.
  TriangleSoup rings = shapes::solid_boundary(17, [](int x, int y, int z) {
    const bool slit = z == 4 && x < 3;
    const bool hole = (x > 2 && x < 7) || (x > 9 && x < 14);
    return y < 3 && z < 10 && !slit && !(hole && z > 2 && z < 7);
  });
  for (WorldPoint& p : rings.vertices)
    if (p.z >= 5) p.z -= .99;
  const Sheet closed = sheet_of(rings, 100);
  CHECK(closed.topology.genus == 2);
  SheetOptions options;
  options.genus = 1;
  const Sheet slit = sheet_of(rings, 100, options);
  check_sheet(slit);
  CHECK(slit.topology.components == 1);
  CHECK(slit.topology.genus == 1);
  CHECK(slit.topology.cut_handles == 1);
  CHECK(signed_volume(slit) == Approx(signed_volume(closed)).epsilon(.01));
  options.genus = 2;
  CHECK(digest(sheet_of(rings, 100, options)) == digest(closed));
}

TEST_CASE("sheet: small components are dropped and the rest is as if they had never been", "[sheet][stage]") {
  const TriangleSoup large = shapes::torus(2, .7, 60, 30);
  TriangleSoup both = shapes::together(large, shapes::box({-.1, -.1, -.1}, {.1, .1, .1}));
  SheetOptions options;
  CHECK(sheet_of(both, 96, options).topology.components == 2);
  options.min_component_area_q16 = int64_t(2000) << 16;
  const Sheet kept = sheet_of(both, 96, options);
  check_sheet(kept);
  CHECK(kept.topology.components == 1);
  CHECK(kept.topology.genus == 1);
  CHECK(kept.topology.dropped_components == 1);
  const Sheet alone = sheet_of(large, 96);
  CHECK(digest(kept.corners) == digest(alone.corners));
  CHECK(std::equal(kept.position.begin(), kept.position.end(), alone.position.begin(), alone.position.end()));
  options.min_component_area_q16 = int64_t(1) << 50;
  CHECK_THROWS_AS(sheet_of(both, 96, options), Error);
}

TEST_CASE("sheet: arguments out of range are refused", "[sheet][stage]") {
  SheetOptions options;
  options.closing_vox = kMaxClosingVox + 1;
  CHECK_THROWS_AS(sheet_of(shapes::box({0, 0, 0}, {1, 1, 1}), 16, options), Error);
}

TEST_CASE("sheet: a coarse proxy has the sheet's vertices and topology, is within a voxel of it, and as large",
          "[sheet][stage]") {
  TestContext context;
  const Pipeline p = sites_of(shapes::torus(2, .7, 60, 30), 96, context);
  const Sheet proxy = build_proxy(p.sites, p.surface.frame, {}, context),
              sheet = build_sheet(p.surface, p.sites, p.samples, {}, context);
  check_sheet(proxy);
  CHECK(proxy.topology.genus == 1);
  REQUIRE(digest(proxy.corners) == digest(sheet.corners));
  for (int64_t v = 0; v < sheet.vertex_count(); ++v)
    REQUIRE(distance_sq_q16(proxy.position[v], sheet.position[v]) <= 65536);
  const int64_t volume = six_volume_vox(sheet, context);
  CHECK(std::abs(six_volume_vox(proxy, context) - volume) < volume / 100);
}

TEST_CASE("sheet: smoothing a coarse proxy takes less than a hundredth of a small ball", "[sheet][stage]") {
  TestContext context;
  for (const int resolution : {24, 48}) {
    const Pipeline p = sites_of(shapes::sphere({0, 0, 0}, 1, 24), resolution, context);
    const Sheet proxy = build_proxy(p.sites, p.surface.frame, {}, context),
                sheet = build_sheet(p.surface, p.sites, p.samples, {}, context);
    const int64_t volume = six_volume_vox(sheet, context);
    INFO("resolution " << resolution << ": " << double(six_volume_vox(proxy, context)) / double(volume));
    CHECK(std::abs(six_volume_vox(proxy, context) - volume) < volume / 100);
  }
}
