// build_sheet against brute force: the solid voxel by voxel, the mesh by counting.
#include <algorithm>
#include <cmath>
#include <map>

#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/sheet/project_simd.h"
#include "isoshell/digest.h"
#include "isoshell/error.h"
#include "isoshell/stages.h"
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

struct Named {
  std::string name;
  std::vector<Voxel> voxels;
};

const Extent kExtent = {56, 52, 60};   // of the dense lattice
const Voxel kOffset = {100, 104, 96};  // of the dense lattice in the sparse one, so that blocks of 128 meet inside
const Extent kSparseExtent = {256, 256, 256};

/// Voxels of the middle of the lattice, 12 off its border, for which inside(x, y, z) holds, relative to the centre.
template <class Inside>
Named filled(std::string name, Inside inside) {
  Named out{std::move(name), {}};
  for (int32_t x = 12; x < kExtent[0] - 12; ++x)
    for (int32_t y = 12; y < kExtent[1] - 12; ++y)
      for (int32_t z = 12; z < kExtent[2] - 12; ++z)
        if (inside(x - kExtent[0] / 2, y - kExtent[1] / 2, z - kExtent[2] / 2)) out.voxels.push_back({x, y, z});
  return out;
}

Named noise(uint64_t seed, uint64_t percent) {
  return filled("noise " + std::to_string(seed) + " at " + std::to_string(percent), [&](int x, int y, int z) {
    return random_bits(seed, uint64_t((x + 50) * 10000 + (y + 50) * 100 + z + 50)) % 100 < percent;
  });
}

Named holed_sphere(int width) {
  return filled("sphere with holes " + std::to_string(width) + " wide", [&](int x, int y, int z) {
    const double r = std::sqrt(double(x * x + y * y + z * z));
    return std::abs(r - 11) <= 0.87 && !(2 * std::abs(x) < width && 2 * std::abs(y) < width);
  });
}

std::vector<Named> all_blobs() {
  std::vector<Named> out;
  for (uint64_t percent : {1, 5, 20, 50, 80}) out.push_back(noise(percent, percent));
  for (int width : {0, 1, 2, 3, 5, 7, 9}) out.push_back(holed_sphere(width));
  out.push_back(
      filled("diagonal wires", [](int x, int y, int z) { return (x == y && y == z) || (x == -y && z == 3); }));
  out.push_back(filled("diagonal tunnels", [](int x, int y, int z) {
    return !((x == y && y == z) || (x == -y && z == 3) || (x == 5 && y == z));
  }));
  out.push_back(filled("two walls", [](int x, int, int) { return x == -2 || x == 1; }));
  out.push_back(filled("one voxel", [](int x, int y, int z) { return x == 0 && y == 0 && z == 0; }));
  return out;
}

oracle::Dense dense_of(const std::vector<Voxel>& voxels) {
  oracle::Dense out(kExtent);
  for (Voxel v : voxels) out.value[out.at(v)] = 1;
  return out;
}

Voxel in_sparse(Voxel v) { return {v.x + kOffset.x, v.y + kOffset.y, v.z + kOffset.z}; }

SiteSet site_set_of(const Named& blob) {
  std::vector<Voxel> voxels;
  for (const Voxel v : blob.voxels) voxels.push_back(in_sparse(v));
  return make_site_set(voxels, kSparseExtent);
}

bool is_solid(const SolidView& solid, Voxel dense) {
  const Voxel v = in_sparse(dense);
  return solid.at(leaf_of_voxel(v)).word(v.x & 7) >> (offset_in_leaf(v) & 63) & 1;
}

int64_t mismatches(Solid& solid, const oracle::Dense& expected) {
  const SolidView view = solid.view();
  int64_t wrong = 0;
  expected.for_each([&](Voxel v) { wrong += is_solid(view, v) != bool(expected.get(v, 0)); });
  return wrong;
}

/// Defects of a quad mesh as the boundary of a solid: edges without exactly two opposite sides, corners with two fans.
int64_t count_defects(const QuadMesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> sides;
  std::vector<std::map<uint32_t, uint32_t>> next(size_t(mesh.corners.voxel_count()));
  int64_t defects = 0;
  for (const Quad& q : mesh.quads)
    for (int k = 0; k < 4; ++k) {
      const uint32_t a = q.corner[k], b = q.corner[(k + 1) % 4], before = q.corner[(k + 3) % 4];
      defects += sides[{a, b}]++ != 0;
      next[a][b] = before;
    }
  for (const auto& side : sides) defects += sides.count({side.first.second, side.first.first}) != 1;
  for (const auto& fan : next) {
    if (fan.empty()) {
      ++defects;
      continue;
    }
    size_t steps = 0;
    uint32_t at = fan.begin()->first;
    do {
      at = fan.at(at);
      ++steps;
    } while (at != fan.begin()->first && fan.count(at) && steps <= fan.size());
    defects += steps != fan.size();
  }
  return defects;
}

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

TEST_CASE("sheet: the closed solid is the one of the definition, voxel by voxel", "[sheet][stage]") {
  TestContext context;
  context.backend = Backend::cpu;  // where these parts run, and what lies in their products is looked at
  CpuExecutor exec(context, "sheet");
  for (const Named& blob : all_blobs())
    for (const int32_t r : {0, 1, 2, 5}) {
      INFO(blob.name << ", r = " << r);
      const SiteSet sites = site_set_of(blob);
      Solid solid = close_sites(exec, sites, r);
      oracle::Dense expected = oracle::closed(dense_of(blob.voxels), r);
      CHECK(mismatches(solid, expected) == 0);
      make_well_composed(exec, solid);
      while (oracle::repair_once(expected)) {
      }
      CHECK(mismatches(solid, expected) == 0);
      fill_cavities(exec, solid);
      CHECK(mismatches(solid, oracle::filled(expected)) == 0);
      const QuadMesh mesh = list_boundary(exec, solid);
      CHECK(count_defects(mesh) == 0);
    }
}

TEST_CASE("sheet: hollows open the solid as far as the closing leaves them empty", "[sheet][stage]") {
  TestContext context;
  context.backend = Backend::cpu;  // where these parts run, and what lies in their products is looked at
  CpuExecutor exec(context, "sheet");
  const auto cube = [](int x, int y, int z) { return std::max({std::abs(x), std::abs(y), std::abs(z)}); };
  std::vector<Named> blobs = {noise(20, 20)};
  for (const int hollow : {1, 3})
    blobs.push_back(filled("cube with a hollow " + std::to_string(2 * hollow + 1) + " wide",
                           [&](int x, int y, int z) { return cube(x, y, z) <= 13 && cube(x, y, z) > hollow; }));
  const std::vector<Voxel> hollows = {{kExtent[0] / 2, kExtent[1] / 2, kExtent[2] / 2}, {30, 20, 35}};
  for (const Named& blob : blobs)
    for (const int32_t r : {0, 2}) {
      INFO(blob.name << ", r = " << r);
      SiteSet sites = site_set_of(blob);
      sites.hollows = Buffer<Voxel>(int64_t(hollows.size()));
      std::transform(hollows.begin(), hollows.end(), sites.hollows.begin(), in_sparse);
      Solid solid = close_sites(exec, sites, r);
      oracle::Dense expected = oracle::closed(dense_of(blob.voxels), r, hollows);
      CHECK(mismatches(solid, expected) == 0);
      make_well_composed(exec, solid);
      while (oracle::repair_once(expected)) {
      }
      fill_cavities(exec, solid, sites.hollows.view());
      CHECK(mismatches(solid, oracle::filled(expected, hollows)) == 0);
      CHECK(count_defects(list_boundary(exec, solid)) == 0);
    }
}

TEST_CASE("sheet: holes close as wide as the closing reaches", "[sheet][stage]") {
  TestContext context;
  context.backend = Backend::cpu;  // where these parts run, and what lies in their products is looked at
  CpuExecutor exec(context, "sheet");
  for (const int width : {1, 3, 5, 7})
    for (const int32_t r : {0, 1, 2, 3, 4}) {
      Solid solid = close_sites(exec, site_set_of(holed_sphere(width)), r);
      const bool is_full = is_solid(solid.view(), {kExtent[0] / 2, kExtent[1] / 2, kExtent[2] / 2});
      INFO("width " << width << ", r = " << r);
      if (width <= 2 * r) CHECK(is_full);
      if (width >= 2 * r + 3) CHECK(!is_full);
    }
}

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

TEST_CASE("sheet: a coarse site holds at least one site, and every site lies in one", "[sheet][stage]") {
  for (const Named& blob : all_blobs()) {
    INFO(blob.name);
    std::vector<Voxel> fine, coarse;
    for (Voxel v : blob.voxels) {
      fine.push_back({v.x + kOffset.x, v.y + kOffset.y, v.z + kOffset.z});
      coarse.push_back({fine.back().x >> 1, fine.back().y >> 1, fine.back().z >> 1});
    }
    TestContext context;
    const SiteSet sites = coarsen_sites(make_site_set(fine, kSparseExtent), context);
    const Extent half = {kSparseExtent[0] / 2, kSparseExtent[1] / 2, kSparseExtent[2] / 2};
    CHECK(digest(sites) == digest(make_site_set(coarse, half)));
    CHECK(sites.voxels.voxel_count() == make_site_set(coarse, half).voxels.voxel_count());
  }
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
