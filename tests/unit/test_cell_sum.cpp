// The split of one triangle between the cells of its corners.
#include <algorithm>

#include "oracle/clip_triangle.h"
#include "support/catch.h"
#include "voxel/cell_sum.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

Local random_local(uint64_t seed, uint64_t& counter, int32_t half) {
  const auto one = [&] { return int32_t(random_bits(seed, counter++) % uint64_t(2 * half + 1)) - half; };
  const int32_t x = one(), y = one(), z = one();
  return {x, y, z};
}
oracle::Point point(Local u) { return {double(u.x), double(u.y), double(u.z)}; }
int nearest(Local p, const Local (&s)[3]) {
  int best = 0;
  for (int i = 1; i < 3; ++i)
    if (bisector_value(p, s[i], s[best]) < 0) best = i;
  return best;
}
int64_t doubled_area(Local a, Local b, Local c) {
  const Vec64 n = cross({b.x - a.x, b.y - a.y, b.z - a.z}, {c.x - a.x, c.y - a.y, c.z - a.z});
  return int64_t(isqrt(uint64_t(dot(n, n))));
}

}  // namespace

TEST_CASE("cell sum: every cell of a triangle gets the area, moment and energy that polygon clipping gives it",
          "[relax][unit]") {
  uint64_t counter = 0;
  int cases[3] = {0, 0, 0};
  while (cases[1] < 3000 || cases[2] < 3000) {
    SplitTriangle split;
    Local seed[3];
    for (Local& p : split.p) p = random_local(7, counter, 400);
    for (Local& s : seed) s = random_local(7, counter, 1500);
    split.area2 = doubled_area(split.p[0], split.p[1], split.p[2]);
    if (split.area2 < 20000) continue;
    int owner[3];
    for (int i = 0; i < 3; ++i) {
      owner[i] = nearest(split.p[i], seed);
      split.s[i] = seed[owner[i]];
    }
    // Keep the triangles all of whose cells own a corner: a cell that reaches in without one is not seen by design.
    bool owned[3] = {};
    for (int o : owner) owned[o] = true;
    const std::vector<oracle::Point> whole = {point(split.p[0]), point(split.p[1]), point(split.p[2])};
    oracle::Moments expected[3];
    bool hidden = false;
    for (int o = 0; o < 3; ++o) {
      std::vector<oracle::Point> part = whole;
      for (int other = 0; other < 3; ++other)
        if (other != o) part = oracle::clip_to_nearer(part, point(seed[o]), point(seed[other]));
      expected[o] = oracle::moments(part);
      hidden |= !owned[o] && expected[o].area2 > 0;
    }
    const int distinct = int(owned[0]) + int(owned[1]) + int(owned[2]);
    if (hidden || distinct == 1) continue;
    ++cases[distinct - 1];

    PieceSum got[3] = {};
    const auto add = [&](int corner, const PieceSum& piece) { got[owner[corner]] = got[owner[corner]] + piece; };
    if (owner[1] == owner[2])
      split.two_cells(0, add);
    else if (owner[2] == owner[0])
      split.two_cells(1, add);
    else if (owner[0] == owner[1])
      split.two_cells(2, add);
    else
      split.three_cells(add);
    for (int o = 0; o < 3; ++o) {
      // Crossings are cut to 1/32768 of an edge and points to whole q8: a few parts in a thousand of the triangle.
      const double slack = 0.004 * double(split.area2);
      CHECK(std::abs(double(got[o].mass) - expected[o].area2) < slack);
      CHECK(std::abs(double(got[o].first_x) / 3 - expected[o].first[0]) < slack * 400);
      CHECK(std::abs(double(got[o].first_z) / 3 - expected[o].first[2]) < slack * 400);
      CHECK(std::abs(double(got[o].second) / 12 - expected[o].second) < slack * 400 * 400);
    }
  }
}

TEST_CASE("cell sum: pieces of a split triangle add up to the whole", "[relax][unit]") {
  const SplitTriangle split{
      {{0, 0, 0}, {256, 0, 0}, {0, 256, 0}}, {{-10, -10, 30}, {300, 20, 5}, {10, 280, -8}}, 65536};
  PieceSum sum = {};
  split.three_cells([&](int, const PieceSum& piece) { sum = sum + piece; });
  CHECK(std::abs(sum.mass - 65536) <= 8);
}
