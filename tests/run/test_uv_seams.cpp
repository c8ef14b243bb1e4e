// Texture coordinates without seams as edges: triangles lie across seams, and each is all in one chart.
#include <algorithm>
#include <cmath>

#include "core/attribute_values.h"
#include "geometry/triangle_search.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/run/run.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

constexpr double kApart = 10;  // between charts

template <class Mesh>
WorldPoint middle_of(const Mesh& mesh, size_t t) {
  const auto& c = mesh.triangles[t];
  return (1. / 3) * (mesh.vertices[c[0]] + mesh.vertices[c[1]] + mesh.vertices[c[2]]);
}

/// The ball is cut into eight by the planes through its middle.
int octant_of(const WorldPoint& p) { return (p.x > 0) + 2 * (p.y > 0) + 4 * (p.z > 0); }

std::array<double, 2> uv_at(int octant, const WorldPoint& p) {
  return {kApart * octant + p.x + .5 * p.z, p.y - .25 * p.z};
}

/// Eight charts, whose seams are edges of the ball's own triangles, and linear coordinates in each.
TriangleSoup ball_in_charts(uint32_t meridians) {
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 2, meridians);
  Attribute uv{kUvName, NumberType::f64, 2, {}, AttributeDomain::corner};
  for (size_t t = 0; t < ball.triangles.size(); ++t)
    for (const uint32_t v : ball.triangles[t]) {
      const auto here = uv_at(octant_of(middle_of(ball, t)), ball.vertices[v]);
      uv.values.insert(uv.values.end(), here.begin(), here.end());
    }
  ball.attributes = {uv};
  return ball;
}

RunResult run_of(TriangleSoup soup, UvSeams uv_seams, std::optional<std::vector<std::string>> attributes = {}) {
  RunRequest request;
  request.options.values.vertices = 400;
  request.options.values.uv_seams = uv_seams;
  request.options.values.attributes = std::move(attributes);
  Context context;
  context.backend = Backend::cpu;
  return run(input_of(std::move(soup), "ball"), request, context);
}

/// By looking at every triangle of the ball that `counts`.
template <class Counts>
MeshPoint nearest(const TriangleSoup& ball, const WorldPoint& p, const Counts& counts) {
  MeshPoint best;
  for (size_t t = 0; t < ball.triangles.size(); ++t) {
    if (!counts(t)) continue;
    const auto& c = ball.triangles[t];
    MeshPoint here = nearest_of_triangle(p, ball.vertices[c[0]], ball.vertices[c[1]], ball.vertices[c[2]]);
    here.triangle = uint32_t(t);
    if (here.distance_sq < best.distance_sq) best = here;
  }
  return best;
}

WorldPoint place_of(const TriangleSoup& ball, const MeshPoint& at) {
  const auto& c = ball.triangles[at.triangle];
  return interpolate(at, ball.vertices[c[0]], ball.vertices[c[1]], ball.vertices[c[2]]);
}

}  // namespace

TEST_CASE("uv seams: each triangle is in the chart under its middle, and has what that chart is nearest to its corners",
          "[seams]") {
  const TriangleSoup ball = ball_in_charts(24);
  const RunResult result = run_of(ball, UvSeams::ignore);
  CHECK(result.record.report.features.seams == 0);
  CHECK(result.record.warnings.empty());
  const Attribute& uv = named(result.mesh.attributes, kUvName);
  const auto all = [](size_t) { return true; };
  int64_t across = 0, torn = 0;
  double largest = 0;
  for (size_t t = 0; t < result.mesh.triangles.size(); ++t) {
    const int chart = octant_of(middle_of(ball, nearest(ball, middle_of(result.mesh, t), all).triangle));
    bool is_across = false;
    for (size_t i = 0; i < 3; ++i) {
      const WorldPoint& p = result.mesh.vertices[result.mesh.triangles[t][i]];
      is_across |= octant_of(middle_of(ball, nearest(ball, p, all).triangle)) != chart;
      const MeshPoint at = nearest(ball, p, [&](size_t s) { return octant_of(middle_of(ball, s)) == chart; });
      const auto expected = uv_at(chart, place_of(ball, at));
      const double* const found = value_of(uv, 3 * t + i);
      torn += std::lround(found[0] / kApart) != chart;
      for (size_t k = 0; k < 2; ++k) largest = std::max(largest, std::abs(found[k] - expected[k]));
    }
    across += is_across;
  }
  CHECK(across > 50);
  CHECK(torn == 0);
  CHECK(largest < 1e-9);
}

TEST_CASE("uv seams: rounding between faces makes none", "[seams]") {
  TriangleSoup ball = ball_in_charts(24);
  const RunResult exact = run_of(ball, UvSeams::keep);
  std::vector<double>& values = ball.attributes[0].values;
  for (size_t i = 0; i < values.size(); ++i) values[i] += 1e-7 * double(i * i % 7);  // other corners, other last digits
  ball.attributes[0].type = NumberType::f32;
  const RunResult rounded = run_of(ball, UvSeams::keep);
  CHECK(rounded.record.report.features.seams == exact.record.report.features.seams);
  CHECK(digest_text(digest(rounded.mesh)) == digest_text(digest(exact.mesh)));
}

TEST_CASE("uv seams: the surface is as if there were no texture coordinates, and its triangles are as good",
          "[seams]") {
  const TriangleSoup ball = ball_in_charts(48);
  const RunResult ignored = run_of(ball, UvSeams::ignore), kept = run_of(ball, UvSeams::keep);
  CHECK(digest_text(digest(ignored.mesh)) == digest_text(digest(run_of(ball, UvSeams::keep, {{}}).mesh)));
  CHECK(kept.record.report.features.seams > 0);
  REQUIRE(ignored.record.quality);
  CHECK(ignored.record.quality->theta_min_deg > 38);
}
