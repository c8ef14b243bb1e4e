// Levels of seeds, coarse to fine.
#include <cmath>

#include "geometry/world_vector.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

WorldPoint unit(const WorldPoint& p) { return (1 / length(p)) * p; }

/// A closed tube along a trefoil knot, thin in seven places: where its coarsest cells are as wide as it is.
TriangleSoup knotted_tube() {
  constexpr uint32_t kAlong = 400, kAround = 24;
  constexpr double kTurn = 6.283185307179586;
  const auto middle = [](double t) {
    const double r = 2 + std::cos(3 * t);
    return WorldPoint{r * std::cos(2 * t), r * std::sin(2 * t), std::sin(3 * t)};
  };
  TriangleSoup soup;
  for (uint32_t i = 0; i < kAlong; ++i) {
    const double t = kTurn * i / kAlong, radius = 0.45 * (1 + 0.6 * std::sin(7 * t));
    const WorldPoint at = middle(t);
    const WorldPoint along = unit(middle(t + 1e-4) - middle(t - 1e-4)), a = unit(cross(along, {at.x, at.y, 0})),
                     b = cross(along, a);
    for (uint32_t j = 0; j < kAround; ++j) {
      const double w = kTurn * j / kAround;
      soup.vertices.push_back(at + radius * std::cos(w) * a + radius * std::sin(w) * b);
    }
  }
  const auto corner = [](uint32_t i, uint32_t j) { return i % kAlong * kAround + j % kAround; };
  for (uint32_t i = 0; i < kAlong; ++i)
    for (uint32_t j = 0; j < kAround; ++j) {
      shapes::add_triangle(soup, corner(i, j), corner(i + 1, j + 1), corner(i + 1, j));
      shapes::add_triangle(soup, corner(i, j), corner(i, j + 1), corner(i + 1, j + 1));
    }
  return soup;
}

}  // namespace

TEST_CASE("levels: the finest goes on from a coarser one, though that one's second round may fail", "[relax][stage]") {
  constexpr int32_t kMostPassesAfterACoarserLevel = 40;
  TestContext context;
  RemeshOptions options;
  options.vertices = 1300;
  for (options.seed = 0; options.seed < 4; ++options.seed) {  // it fails with the last
    CAPTURE(options.seed);
    const Relaxed relaxed = relax(prepare(knotted_tube(), options, context), context);
    CHECK(relaxed.report.relax.passes <= kMostPassesAfterACoarserLevel);
  }
}
