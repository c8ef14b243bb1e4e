// What is closest on triangles, taken many at a time on the CPU, against the definitions.
#include "cpu/walk_ahead.h"
#include "isoshell/stages.h"
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

}  // namespace

TEST_CASE("closest points: lanes find those of the definition, on needles and points too", "[closest][stage]") {
  uint64_t drawn = 0;
  for (int round = 0; round < 3000; ++round) {
    const int32_t size = round % 4 == 0 ? 3 : round % 4 == 1 ? 1 << 21 : 400, far = round % 3 == 0 ? 1 << 21 : 500;
    FootLanes lanes;
    const int count = 1 + round % FootLanes::kLanes;
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
  TbbExecutor exec(context, "test");
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
    walk_to_targets(exec, "walk", walk_onto(sheet), home.view(), step(0));
    exec.for_each("walk", count, WalkToTarget<NoteArrivals>{walk_onto(sheet), home.view(), step(1)});
    for (int64_t i = 0; i < count; ++i) CHECK((vertex[0][i] == vertex[1][i] && point[0][i] == point[1][i]));
  }
}
