// What is closest on triangles, taken many at a time on the CPU, against the definitions.
#include "cpu/relax/walk_ahead.h"
#include "cpu/sheet/project_simd.h"
#include "isoshell/advanced/stages.h"
#include "support/catch.h"
#include "support/relax_sheets.h"
#include "support/shapes.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

int32_t draw(uint64_t& drawn, int32_t reach) {
  return int32_t(random_bits(7, drawn++) % uint64_t(2 * reach + 1)) - reach;
}
PointQ8 draw_near(uint64_t& drawn, PointQ8 p, int32_t reach) {
  return {p.x + draw(drawn, reach), p.y + draw(drawn, reach), p.z + draw(drawn, reach)};
}

/// Notes where elements arrive.
struct NoteArrivals {
  View<const PointQ8> target;
  View<uint32_t> vertex;
  View<PointQ8> point;
  bool aims(int64_t i, PointQ8& p) const {
    p = target[i];
    return i % 5 != 0;
  }
  void arrives(int64_t i, uint32_t v, PointQ8 p) const { vertex[i] = v, point[i] = p; }
};

/// Counts the vertices that lanes put elsewhere than the step does.
int64_t projected_elsewhere(const TriangleSoup& soup, int32_t resolution, int32_t off_q8, bool may_bridge) {
  TestContext context;
  CpuExecutor exec(context, "test");
  const auto [lo, hi] = bounding_box(soup);
  const LatticeSurface surface = snap_surface(soup, LatticeFrame::around(lo, hi, resolution), context);
  const SiteSet sites = voxelize(surface, context);
  const SiteSamples samples = sample_sites(surface, sites, context);
  uint64_t drawn = 0;
  const int64_t count = samples.sample.size();
  Buffer<PointQ8> smooth(count), point[2] = {Buffer<PointQ8>(count), Buffer<PointQ8>(count)};
  Buffer<uint32_t> triangle[2] = {Buffer<uint32_t>(count), Buffer<uint32_t>(count)};
  for (int64_t i = 0; i < count; ++i)
    smooth[i] = draw_near(drawn, voxel_centre(voxel_of_index(sites.voxels.view(), i)), off_q8);
  const SitedSurfaceView view = {surface.points.view(), surface.triangles.view(), sites.voxels.view(),
                                 samples.first.view(), samples.triangles.view()};
  const auto step = [&](int k) {
    return sheet_steps::ProjectVertex{view, may_bridge, smooth.view(), point[k].view(), triangle[k].view()};
  };
  CpuKernels::ProjectVertices::run(exec, sites.voxels.view(), step(0));
  PlainKernels::ProjectVertices::run(exec, sites.voxels.view(), step(1));
  int64_t elsewhere = 0;
  for (int64_t i = 0; i < count; ++i)
    elsewhere += point[0][i] != point[1][i] || triangle[0][i] != triangle[1][i] ? 1 : 0;
  return elsewhere;
}

}  // namespace

TEST_CASE("closest points: lanes find those of the definition, on needles and points too", "[closest][stage]") {
  uint64_t drawn = 0;
  for (int round = 0; round < 3000; ++round) {
    const int32_t size = round % 4 == 0 ? 3 : round % 4 == 1 ? 1 << 21 : 400, far = round % 3 == 0 ? 1 << 21 : 500;
    FootSimd lanes;
    const int count = 1 + round % FootSimd::kLanes;
    for (int i = 0; i < count; ++i) {
      const PointQ8 a = draw_near(drawn, {1 << 21, 1 << 21, 1 << 21}, 1 << 20), b = draw_near(drawn, a, size);
      PointQ8 c = draw_near(drawn, a, size);
      if (i % 7 == 0) c = {2 * b.x - a.x, 2 * b.y - a.y, 2 * b.z - a.z + draw(drawn, 1)};
      if (i % 11 == 0) c = i % 2 ? a : b;
      lanes.p.set(i, draw_near(drawn, i % 2 ? a : b, far));
      lanes.a.set(i, a), lanes.b.set(i, b), lanes.c.set(i, c);
    }
    lanes.find(count);
    for (int i = 0; i < count; ++i) {
      const PointQ8 p = lanes.p.at(i);
      const PointQ8 foot = closest_point_on_triangle(p, lanes.a.at(i), lanes.b.at(i), lanes.c.at(i));
      CHECK((lanes.foot.at(i) == foot && lanes.distance_sq[i] == double(distance_sq_q16(foot, p))));
    }
  }
}

TEST_CASE("walks: those in lanes arrive where one after the other do", "[walk][stage]") {
  TestContext context;
  CpuExecutor exec(context, "test");
  for (const Sheet& sheet : {torus_sheet(), plate_sheet()}) {
    const int64_t count = 5000;
    uint64_t drawn = 0;
    Buffer<uint32_t> home(count), vertex[2] = {Buffer<uint32_t>(count), Buffer<uint32_t>(count)};
    Buffer<PointQ8> target(count), point[2] = {Buffer<PointQ8>(count), Buffer<PointQ8>(count)};
    for (int64_t i = 0; i < count; ++i) {
      home[i] = uint32_t(random_bits(1, uint64_t(i)) % uint64_t(sheet.vertex_count()));
      target[i] = draw_near(drawn, sheet.position[home[i]], i % 3 == 0 ? 3000 : 300);
      for (int k = 0; k < 2; ++k) vertex[k][i] = kNone, point[k][i] = {0, 0, 0};
    }
    const auto step = [&](int k) { return NoteArrivals{target.view(), vertex[k].view(), point[k].view()}; };
    CpuKernels::Walks::to_targets(exec, "walk", walk_onto(sheet), home.view(), step(0));
    PlainKernels::Walks::to_targets(exec, "walk", walk_onto(sheet), home.view(), step(1));
    for (int64_t i = 0; i < count; ++i) CHECK((vertex[0][i] == vertex[1][i] && point[0][i] == point[1][i]));
  }
}

TEST_CASE("sheet: vertices are put in lanes where each would go alone", "[sheet][stage]") {
  const TriangleSoup torus = shapes::torus(2, 0.7, 160, 70), soup = shapes::random_soup(60, 0.5, 1, 3);
  for (const bool may_bridge : {false, true})
    for (const int32_t off_q8 : {100, 300, 700, 2000}) {
      CHECK(projected_elsewhere(torus, 100, off_q8, may_bridge) == 0);  // many small triangles a voxel
      CHECK(projected_elsewhere(soup, 60, off_q8, may_bridge) == 0);
    }
}
