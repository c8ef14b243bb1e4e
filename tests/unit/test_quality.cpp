// Quality against meshes whose measures are known by hand.
#include <cmath>

#include "isoshell/error.h"
#include "isoshell/quality.h"
#include "support/catch.h"

using namespace isoshell;

TEST_CASE("quality: the regular tetrahedron has perfect triangles and only irregular vertices", "[quality][unit]") {
  const TriangleMesh mesh = {{{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}},
                             {{{0, 1, 2}}, {{0, 3, 1}}, {{0, 2, 3}}, {{1, 3, 2}}}};
  const MeshQuality q = measure_quality(mesh);
  CHECK(q.q_min == Approx(1));
  CHECK(q.q_avg == Approx(1));
  CHECK(q.theta_min_deg == Approx(60));
  CHECK(q.theta_max_deg == Approx(60));
  CHECK(q.below_30_deg_pct == 0);
  CHECK(q.irregular_ratio == 1);
  CHECK(q.edge_cv == Approx(0).margin(1e-7));
  CHECK(q.area_cv == Approx(0).margin(1e-7));
}

TEST_CASE("quality: one right triangle beside one needle", "[quality][unit]") {
  const TriangleMesh mesh = {{{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {100, 0, 0}, {100, 1, 0}}, {{{0, 1, 2}}, {{0, 3, 4}}}};
  const MeshQuality q = measure_quality(mesh);
  const double right = 6 / std::sqrt(3) * 1 / 5;  // inradius 1, longest edge 5
  const double smallest = std::atan(3.0 / 4) * 180 / 3.141592653589793,
               needle = std::atan(1.0 / 100) * 180 / 3.141592653589793;
  CHECK(2 * q.q_avg - q.q_min == Approx(right));
  CHECK(q.theta_min_deg == Approx(needle));
  CHECK(q.theta_min_at == 1);
  CHECK(q.theta_avg_deg == Approx((smallest + needle) / 2));
  CHECK(q.theta_max_deg == Approx(90));
  CHECK(q.below_30_deg_pct == Approx(50));
}

TEST_CASE("quality: triangles without area count as worst, and none at all as zero", "[quality][unit]") {
  const MeshQuality flat = measure_quality({{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{{0, 1, 2}}}});
  CHECK(flat.q_min == 0);
  CHECK(flat.theta_min_deg == 0);
  CHECK(flat.theta_min_at == 0);
  const MeshQuality point = measure_quality({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}, {{{0, 1, 2}}}});
  CHECK(point.q_min == 0);
  CHECK(measure_quality({}).q_avg == 0);
  CHECK_THROWS_AS(measure_quality({{{0, 0, 0}}, {{{0, 0, 1}}}}), Error);
}

TEST_CASE("quality: the least angle between triangles is that of the narrowest of all pairs at an edge",
          "[quality][unit]") {
  const double up = std::tan(7 * 3.141592653589793 / 180);
  const std::vector<WorldPoint> points{{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {1, -1, 0}, {1, 1, up}, {1, 0, 1}};
  const auto least = [&](std::vector<std::array<uint32_t, 3>> triangles) {
    return find_least_dihedral({points, std::move(triangles)});
  };
  CHECK(least({{{0, 1, 2}}}).degrees == 180);               // one triangle has none
  CHECK(least({{{0, 1, 2}}, {{1, 0, 3}}}).degrees == 180);  // flat
  CHECK(least({{{0, 1, 2}}, {{1, 0, 5}}}).degrees == Approx(90));
  CHECK(least({{{0, 1, 2}}, {{0, 1, 2}}}).degrees == 0);  // on one another
  const LeastDihedral three = least({{{0, 1, 2}}, {{1, 0, 5}}, {{1, 0, 4}}, {{0, 1, 3}}});
  CHECK(three.degrees == Approx(7));
  CHECK(three.middle.x == 1);
  CHECK(three.middle.y == 0);
}
