// Where attributes of corners or faces jump, the result has edges; its corners and faces have the values of their side.
#include <algorithm>
#include <cmath>
#include <functional>
#include <set>
#include <utility>

#include "core/attribute_values.h"
#include "features/curves/find_curves.h"
#include "features/mesh/weld_for_features.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/transfer_attributes.h"
#include "isoshell/error.h"
#include "isoshell/options/option_text.h"
#include "isoshell/run/run.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

using Values = std::vector<double>;

/// The surface of a bar from the origin to (2, 1, 1), with vertices n to a unit: some of them lie on x = 1.
TriangleSoup bar(int n) {
  TriangleSoup soup;
  const double size[] = {2, 1, 1};
  for (size_t axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const size_t a = (axis + 1) % 3, b = (axis + 2) % 3;
      const int columns = int(size[a]) * n, rows = int(size[b]) * n;
      const auto first = uint32_t(soup.vertices.size());
      for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
          double at[3];
          at[axis] = side * size[axis];
          at[a] = double(i) / n;
          at[b] = double(j) / n;
          soup.vertices.push_back({at[0], at[1], at[2]});
        }
      for (int j = 0; j < rows; ++j)
        for (int i = 0; i < columns; ++i) {
          const auto p = [&](int di, int dj) { return first + uint32_t((j + dj) * (columns + 1) + i + di); };
          const uint32_t corner[] = {p(0, 0), p(1, 0), p(1, 1), p(0, 1)};
          shapes::add_triangle(soup, corner[0], corner[side ? 1 : 2], corner[side ? 2 : 1]);
          shapes::add_triangle(soup, corner[0], corner[side ? 2 : 3], corner[side ? 3 : 2]);
        }
    }
  return soup;
}

template <class Mesh>
WorldPoint middle_of(const Mesh& mesh, size_t t) {
  const auto& c = mesh.triangles[t];
  return (1. / 3) * (mesh.vertices[c[0]] + mesh.vertices[c[1]] + mesh.vertices[c[2]]);
}

/// Which of the bar's six sides, by the place of a point on it.
int side_of(const WorldPoint& p) {
  const double to_side[] = {p.x, 2 - p.x, p.y, 1 - p.y, p.z, 1 - p.z};
  return int(std::min_element(to_side, to_side + 6) - to_side);
}

/// Corners have what `value` says of their face's middle and their own place.
using OfCorner = std::function<Values(const WorldPoint& middle, const WorldPoint& corner)>;
Attribute of_corners(const TriangleSoup& soup, const std::string& name, int32_t components, const OfCorner& value) {
  Attribute a{name, NumberType::f64, components, {}, AttributeDomain::corner};
  for (size_t t = 0; t < soup.triangles.size(); ++t)
    for (const uint32_t v : soup.triangles[t]) {
      const Values here = value(middle_of(soup, t), soup.vertices[v]);
      a.values.insert(a.values.end(), here.begin(), here.end());
    }
  return a;
}

/// A chart for each half of each side, on which texture coordinates are linear.
Values uv_of_charts(const WorldPoint& middle, const WorldPoint& p) {
  const double chart = 2 * side_of(middle) + (middle.x > 1);
  return {10 * chart + p.x + .5 * p.y, p.z - .25 * p.y};
}

/// A chart for each half.
Values uv_of_halves(const WorldPoint& middle, const WorldPoint& p) {
  return {10. * (middle.x > 1) + p.x + .5 * p.y, p.z - .25 * p.y};
}

/// The four long sides are one chart, unrolled: both sides of its seam, at y = z = 0, are in it.
Values uv_unrolled(const WorldPoint& middle, const WorldPoint& p) {
  switch (side_of(middle)) {
    case 2:
      return {4 - p.z, p.x};
    case 3:
      return {1 + p.z, p.x};
    case 4:
      return {p.y, p.x};
    case 5:
      return {3 - p.y, p.x};
    default:
      return {10 + p.y, p.z};
  }
}

RunResult run_of(TriangleSoup soup, int64_t vertices, const std::string& features = "auto", int threads = 0,
                 const std::string& attributes = "all", UvSeams uv_seams = UvSeams::keep) {
  RunRequest request;
  request.options.values.vertices = vertices;
  request.options.values.features = parse_features("features", features);
  request.options.values.attributes = parse_attributes("attributes", attributes);
  request.options.values.uv_seams = uv_seams;
  Context context;
  context.backend = Backend::cpu;
  context.threads = threads;
  return run(input_of(std::move(soup), "part"), request, context);
}

/// Largest difference of the corners from what the input says of their places.
double largest_error(const TriangleMesh& mesh, const std::string& name, const OfCorner& value) {
  const Attribute& a = named(mesh.attributes, name);
  double largest = 0;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t i = 0; i < 3; ++i) {
      const Values expected = value(middle_of(mesh, t), mesh.vertices[mesh.triangles[t][i]]);
      for (size_t k = 0; k < expected.size(); ++k)
        largest = std::max(largest, std::abs(value_of(a, 3 * t + i)[k] - expected[k]));
    }
  return largest;
}

/// How far faces reach over the plane x = 1, at most.
double reach_over_middle(const TriangleMesh& mesh) {
  double largest = 0;
  for (const auto& t : mesh.triangles) {
    double lo = 2, hi = 0;
    for (const uint32_t v : t) {
      lo = std::min(lo, mesh.vertices[v].x);
      hi = std::max(hi, mesh.vertices[v].x);
    }
    largest = std::max(largest, std::min(hi - 1, 1 - lo));
  }
  return largest;
}

Attribute halves(const TriangleSoup& soup, const std::string& name) {
  Attribute a{name, NumberType::i32, 1, {}, AttributeDomain::face, {}, {"near", "far"}};
  for (size_t t = 0; t < soup.triangles.size(); ++t) a.values.push_back(middle_of(soup, t).x > 1);
  return a;
}

constexpr double kSnapped = 1e-3;  // 1/256 voxel is a twentieth of it

}  // namespace

TEST_CASE("seams: no face lies on two charts, and a linear field is that of every corner", "[seams]") {
  TriangleSoup soup = bar(4);
  soup.attributes = {of_corners(soup, kUvName, 2, uv_of_charts)};
  const RunResult result = run_of(soup, 1500);
  CHECK(result.record.report.features.kept);
  CHECK(result.record.report.features.patches == 10);  // two ends, and four sides of two halves
  CHECK(result.record.report.features.seams == 4);     // the ring around the middle; the others are creases
  CHECK(reach_over_middle(result.mesh) < kSnapped);
  CHECK(largest_error(result.mesh, kUvName, uv_of_charts) < kSnapped);
}

TEST_CASE("seams: the corners of a linear field are right to rounding where the vertices lie on the source",
          "[seams]") {
  TriangleSoup soup = bar(4);
  soup.attributes = {of_corners(soup, kUvName, 2, uv_of_charts)};
  const TriangleSoup fine = bar(7 * 4);  // its vertices lie on the coarse one's faces, edges and corners
  TriangleMesh mesh{fine.vertices, fine.triangles};
  Context context;
  mesh.attributes = transfer_attributes(soup, soup.attributes, mesh, context);
  CHECK(largest_error(mesh, kUvName, uv_of_charts) < 1e-12);
}

TEST_CASE("seams: they are kept where creases are not asked for", "[seams]") {
  TriangleSoup soup = bar(4);
  soup.attributes = {of_corners(soup, kUvName, 2, uv_of_halves)};
  const RunResult result = run_of(soup, 1500, "off");
  CHECK(result.record.report.features.kept);
  CHECK(result.record.report.features.patches == 2);
  CHECK(reach_over_middle(result.mesh) < kSnapped);
  CHECK(result.record.topology->is_closed_manifold());
  CHECK(result.record.vertices == 1500);
  CHECK(largest_error(result.mesh, kUvName, uv_of_halves) < .1);  // edges are rounded off
}

TEST_CASE("seams: both sides of a seam within one chart keep their own", "[seams]") {
  TriangleSoup soup = bar(4);
  soup.attributes = {of_corners(soup, kUvName, 2, uv_unrolled)};
  const RunResult result = run_of(soup, 1500);
  CHECK(result.record.report.features.kept);
  CHECK(largest_error(result.mesh, kUvName, uv_unrolled) < kSnapped);
}

TEST_CASE("seams: cells on both sides of a seam within one chart are as many as were asked for", "[seams]") {
  TriangleSoup soup = bar(4);
  soup.attributes = {of_corners(soup, kUvName, 2, uv_unrolled)};
  const RunResult result = run_of(soup, 1500, "off");
  CHECK(result.record.report.features.kept);
  CHECK(result.record.report.dual.inserted_seeds == 0);
}

TEST_CASE("seams: both sides of a slit keep their own up to its end", "[seams]") {
  // A slit along half of the ridge at y = 1, z = 1: the jump rises from its end at x = 1 on.
  const OfCorner slit = [](const WorldPoint& middle, const WorldPoint& p) {
    const double jump = side_of(middle) == 5 && p.y == 1 ? std::max(0., p.x - 1) : 0;
    return Values{p.x + 5 * jump, p.y + p.z};
  };
  TriangleSoup soup = bar(1);
  soup.attributes = {of_corners(soup, kUvName, 2, slit)};
  const RunResult result = run_of(soup, 2000);
  REQUIRE(result.record.report.features.kept);
  const Attribute& uv = named(result.mesh.attributes, kUvName);
  int64_t wrong = 0, on_slit = 0;
  for (size_t t = 0; t < result.mesh.triangles.size(); ++t)
    for (size_t i = 0; i < 3; ++i) {
      const WorldPoint& p = result.mesh.vertices[result.mesh.triangles[t][i]];
      if (p.x < 1 || p.x > 1.99 || std::abs(p.y - 1) > kSnapped || std::abs(p.z - 1) > kSnapped) continue;
      const double expected = p.x + (side_of(middle_of(result.mesh, t)) == 5 ? 5 * (p.x - 1) : 0);
      ++on_slit;
      wrong += std::abs(value_of(uv, 3 * t + i)[0] - expected) > 6 * kSnapped;
    }
  CHECK(on_slit > 50);
  CHECK(wrong == 0);
}

TEST_CASE("seams: faces have the material of the input under them, and it ends at an edge", "[seams]") {
  TriangleSoup soup = bar(4);
  soup.attributes = {halves(soup, kMaterialName)};
  const RunResult result = run_of(soup, 1500);
  CHECK(reach_over_middle(result.mesh) < kSnapped);
  const Attribute& material = named(result.mesh.attributes, kMaterialName);
  CHECK(material.labels == std::vector<std::string>{"near", "far"});
  int64_t wrong = 0;
  for (size_t t = 0; t < result.mesh.triangles.size(); ++t)
    wrong += material.values[t] != (middle_of(result.mesh, t).x > 1);
  CHECK(wrong == 0);
}

TEST_CASE("seams: numbers of faces are those under them, and make no edges", "[seams]") {
  TriangleSoup soup = bar(4);
  Attribute heat = halves(soup, "heat");
  heat.labels.clear();
  soup.attributes = {heat};
  const RunResult result = run_of(soup, 1500);
  CHECK(reach_over_middle(result.mesh) > kSnapped);
  const Attribute& found = named(result.mesh.attributes, "heat");
  int64_t wrong = 0;
  for (size_t t = 0; t < result.mesh.triangles.size(); ++t)
    wrong += found.values[t] != (middle_of(result.mesh, t).x > 1);
  CHECK(wrong == 0);
}

TEST_CASE("seams: no corner of a crease has a normal of the other side", "[seams]") {
  const OfCorner flat = [](const WorldPoint& middle, const WorldPoint&) {
    Values n(3, 0);
    n[size_t(side_of(middle) / 2)] = side_of(middle) % 2 ? 3 : -3;  // of any length
    return n;
  };
  TriangleSoup soup = bar(4);
  soup.attributes = {of_corners(soup, kNormalName, 3, flat)};
  const RunResult result = run_of(soup, 1500);
  REQUIRE(result.record.report.features.kept);
  const OfCorner unit = [&](const WorldPoint& middle, const WorldPoint& p) {
    Values n = flat(middle, p);
    for (double& x : n) x /= 3;
    return n;
  };
  CHECK(largest_error(result.mesh, kNormalName, unit) == 0);
  CHECK(named(result.mesh.attributes, kNormalName).values.size() / 3 <
        2 * result.mesh.vertices.size());  // shared within a side
}

TEST_CASE("seams: smooth normals are one a vertex, of length 1", "[seams]") {
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 2, 48);
  ball.attributes = {of_corners(ball, kNormalName, 3, [](const WorldPoint&, const WorldPoint& p) {
    return Values{p.x, p.y, p.z};
  })};
  const RunResult result = run_of(ball, 500);
  const Attribute& normal = named(result.mesh.attributes, kNormalName);
  REQUIRE(normal.values.size() == 1500);
  double largest = 0;
  for (size_t v = 0; v < 500; ++v) {
    const WorldPoint n{normal.values[3 * v], normal.values[3 * v + 1], normal.values[3 * v + 2]};
    largest = std::max(largest, std::abs(length(n) - 1));
    CHECK(dot(n, result.mesh.vertices[v]) > 1.99);
  }
  CHECK(largest < 1e-12);
}

TEST_CASE("seams: without the attributes the surface is as if there were none", "[seams]") {
  TriangleSoup soup = bar(4);
  const std::string bare = digest_text(digest(run_of(soup, 800).mesh));
  soup.attributes = {of_corners(soup, kUvName, 2, uv_of_halves), halves(soup, kGroupName)};
  CHECK(digest_text(digest(run_of(soup, 800, "auto", 0, "none").mesh)) == bare);
  CHECK(digest_text(digest(run_of(soup, 800).mesh)) != bare);
  CHECK(digest_text(digest(run_of(soup, 800, "auto", 0, "uv").mesh)) ==
        digest_text(digest(run_of(soup, 800, "auto", 0, "group").mesh)));
}

TEST_CASE("seams: remesh() makes those of all attributes of its input, a run those of what it keeps", "[seams]") {
  TriangleSoup soup = bar(4);
  Attribute quarter{kGroupName, NumberType::i32, 1, {}, AttributeDomain::face, {}, {"end", "rest"}};
  for (size_t t = 0; t < soup.triangles.size(); ++t) quarter.values.push_back(middle_of(soup, t).x > .5);
  soup.attributes = {of_corners(soup, kUvName, 2, uv_of_halves), quarter};
  RemeshOptions options;
  options.vertices = 800;
  options.features.creases = Features::Creases::off;
  Context context;
  context.backend = Backend::cpu;
  CHECK(remesh(soup, options, context).report.features.patches == 3);
  for (const auto& [names, patches] : {std::pair("all", 3), {"uv", 2}, {"group", 2}, {"uv,group", 3}, {"none", 0}})
    CHECK(run_of(soup, 800, "off", 0, names).record.report.features.patches == patches);
  options.uv_seams = UvSeams::ignore;
  CHECK(remesh(soup, options, context).report.features.patches == 2);
}

TEST_CASE("seams: any number of threads gives the same values", "[seams]") {
  TriangleSoup soup = bar(6);
  soup.attributes = {of_corners(soup, kUvName, 2, uv_of_charts), halves(soup, kMaterialName)};
  const RunResult one = run_of(soup, 900, "auto", 1), many = run_of(soup, 900, "auto", 3);
  CHECK(digest_text(digest(one.mesh)) == digest_text(digest(many.mesh)));
  for (size_t a = 0; a < 2; ++a) {
    CHECK(one.mesh.attributes[a].values == many.mesh.attributes[a].values);
    CHECK(one.mesh.attributes[a].index == many.mesh.attributes[a].index);
  }
}

TEST_CASE("seams: those too close together are left out, which is said, and creases stay", "[seams]") {
  TriangleSoup soup = bar(12);
  Attribute chess{kGroupName, NumberType::i32, 1, {}, AttributeDomain::face, {}, {"black", "white"}};
  for (size_t t = 0; t < soup.triangles.size(); ++t) chess.values.push_back(double(t % 2));
  soup.attributes = {chess, of_corners(soup, kUvName, 2, uv_of_halves)};
  const RunResult result = run_of(soup, 1000);
  CHECK(result.record.report.features.kept);
  CHECK(reach_over_middle(result.mesh) < kSnapped);
  REQUIRE(result.record.warnings.size() == 1);
  CHECK(result.record.warnings[0].find("triangles may lie across the seams of group") != std::string::npos);
}

TEST_CASE("seams: of a surface with a hole they are kept beside its cap", "[seams]") {
  TriangleSoup soup = bar(4);
  soup.attributes = {of_corners(soup, kUvName, 2, uv_of_halves)};
  soup.triangles.pop_back();
  soup.attributes[0].values.resize(6 * soup.triangles.size());
  const RunResult result = run_of(soup, 1000);
  CHECK(result.record.report.features.kept);
  CHECK(named(result.mesh.attributes, kUvName).index.size() == 3 * result.mesh.triangles.size());
  CHECK(std::any_of(result.mesh.gap.begin(), result.mesh.gap.end(), [](uint8_t flag) { return flag != 0; }));
}

TEST_CASE("seams: those of charts are no edges where they are ignored, and creases and materials still are",
          "[seams]") {
  const OfCorner nearest_of_chart = [](const WorldPoint& middle, const WorldPoint& p) {
    return uv_of_charts(middle, {middle.x > 1 ? std::max(p.x, 1.) : std::min(p.x, 1.), p.y, p.z});
  };
  TriangleSoup soup = bar(4);
  soup.attributes = {of_corners(soup, kUvName, 2, uv_of_charts)};
  const RunResult across = run_of(soup, 1500, "auto", 0, "all", UvSeams::ignore);
  CHECK(across.record.report.features.patches == 6);
  CHECK(across.record.report.features.seams == 0);
  CHECK(reach_over_middle(across.mesh) > kSnapped);
  CHECK(largest_error(across.mesh, kUvName, nearest_of_chart) < kSnapped);

  soup.attributes.push_back(halves(soup, kMaterialName));
  const RunResult cut = run_of(soup, 1500, "auto", 0, "all", UvSeams::ignore);
  CHECK(cut.record.report.features.patches == 10);
  CHECK(reach_over_middle(cut.mesh) < kSnapped);
  CHECK(largest_error(cut.mesh, kUvName, uv_of_charts) < kSnapped);
}

TEST_CASE("seams: on a flat part a seam is a curve, on a crease it is the crease", "[seams]") {
  const FeatureMesh mesh = weld_for_features(bar(2));
  CurveOptions options{CreaseMode::threshold, 30, .1};
  for (uint32_t a = 0; a < mesh.vertices.size(); ++a)
    for (uint32_t b = 0; b < mesh.vertices.size(); ++b) {
      const WorldPoint &p = mesh.vertices[a], &q = mesh.vertices[b];
      const bool around_middle = p.x == 1 && q.x == 1, along_ridge = p.y == 1 && p.z == 1 && q.y == 1 && q.z == 1;
      if (a != b && length(q - p) < .6 && (around_middle || along_ridge)) options.seams.push_back({a, b});
    }
  options.seams.push_back({0, uint32_t(mesh.vertices.size()) - 1});  // no edge
  const auto count = [&](CurveKind kind) {
    const CurveNetwork network = find_curves(mesh, options);
    return std::count_if(network.curves.begin(), network.curves.end(),
                         [&](const FeatureCurve& c) { return c.kind == kind; });
  };
  CHECK(count(CurveKind::seam) == 4);
  CHECK(count(CurveKind::crease) == 16);  // the long ones end where the ring meets them
  options.mode = CreaseMode::off;
  CHECK(count(CurveKind::seam) == 6);  // the ring in two and a half parts, and the ridge in two
  CHECK(count(CurveKind::crease) == 0);
}
