// Sizing fields and adaptivity together with creases, borders that are kept and seams: edges follow the lengths asked
// for, and what is cut stays.
#include <algorithm>
#include <cmath>
#include <functional>

#include "geometry/world_vector.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

class Field final : public SizingField {
 public:
  explicit Field(std::function<double(const WorldPoint&)> at) : at_(std::move(at)) {}
  std::vector<double> lengths_at(const std::vector<WorldPoint>& points) const override {
    std::vector<double> out;
    for (const WorldPoint& p : points) out.push_back(at_(p));
    return out;
  }

 private:
  std::function<double(const WorldPoint&)> at_;
};

/// Four times as long at the top, z = 1, as at the bottom, z = -1.
double rising(const WorldPoint& p) { return .05 * (1 + 1.5 * (p.z + 1)); }

RemeshOptions with_field(std::optional<int64_t> vertices) {
  RemeshOptions options;
  options.sizing = std::make_shared<Field>(rising);
  options.vertices = vertices;
  return options;
}

RemeshResult meshed(const TriangleSoup& soup, const RemeshOptions& options) {
  TestContext context;
  return remesh(soup, options, context);
}

TriangleSoup cube() { return shapes::box({-1, -1, -1}, {1, 1, 1}); }

constexpr double kThick = .2;

/// A disc of n sides around x, from -kThick to kThick, closed by fans.
TriangleSoup disc(uint32_t n) {
  TriangleSoup soup;
  for (const double x : {-kThick, kThick})
    for (uint32_t i = 0; i < n; ++i) {
      const double angle = 2 * 3.14159265358979 * i / n;
      soup.vertices.push_back({x, std::cos(angle), std::sin(angle)});
    }
  for (uint32_t i = 0; i < n; ++i) {
    const uint32_t j = (i + 1) % n;
    shapes::add_triangle(soup, i, j, n + j);
    shapes::add_triangle(soup, i, n + j, n + i);
  }
  for (uint32_t i = 1; i + 1 < n; ++i) {
    shapes::add_triangle(soup, 0, i + 1, i);
    shapes::add_triangle(soup, n, n + i, n + i + 1);
  }
  return soup;
}

/// The square from -1 to 1 in the plane y = 0, of n x n squares.
TriangleSoup square(uint32_t n) {
  TriangleSoup soup;
  for (uint32_t i = 0; i <= n; ++i)
    for (uint32_t j = 0; j <= n; ++j) soup.vertices.push_back({2. * i / n - 1, 0, 2. * j / n - 1});
  for (uint32_t i = 0; i < n; ++i)
    for (uint32_t j = 0; j < n; ++j) {
      const uint32_t a = i * (n + 1) + j, b = a + n + 1;
      shapes::add_triangle(soup, a, b, b + 1);
      shapes::add_triangle(soup, a, b + 1, a + 1);
    }
  return soup;
}

/// A slab a quarter as thick as wide, whose texture coordinates jump in the plane x = 0.
TriangleSoup slab_with_seam() {
  TriangleSoup soup = square(24);
  const TriangleSoup back = soup;
  for (const WorldPoint& p : back.vertices) soup.vertices.push_back({p.x, .5, p.z});
  const auto n = uint32_t(back.vertices.size());
  for (const auto& t : back.triangles) shapes::add_triangle(soup, n + t[0], n + t[2], n + t[1]);
  const auto wall = [&](uint32_t a, uint32_t b) {  // from the front's border to that of the back
    shapes::add_triangle(soup, a, n + b, b);
    shapes::add_triangle(soup, a, n + a, n + b);
  };
  for (uint32_t i = 0; i < 24; ++i) {
    wall(i, i + 1), wall(24 * 25 + i + 1, 24 * 25 + i);
    wall((i + 1) * 25, i * 25), wall(i * 25 + 24, (i + 1) * 25 + 24);
  }
  Attribute uv{"uv", NumberType::f64, 2, {}, AttributeDomain::corner};
  for (const auto& t : soup.triangles) {
    const bool is_right =
        soup.vertices[t[0]].x + soup.vertices[t[1]].x + soup.vertices[t[2]].x > 0;  // the seam is the plane x = 0
    for (const uint32_t v : t)
      uv.values.insert(uv.values.end(), {soup.vertices[v].x + 10 * is_right, soup.vertices[v].z + soup.vertices[v].y});
  }
  soup.attributes.push_back(std::move(uv));
  return soup;
}

/// Edges against the field at their middles.
struct EdgeErrors {
  double factor = 0;           ///< mean of length / field
  double mean = 0;             ///< of |length / (factor x field) - 1|
  double bottom = 0, top = 0;  ///< mean of length / (factor x field) in the lowest and the highest quarter
};
EdgeErrors edge_errors(const TriangleMesh& mesh) {
  std::vector<std::array<double, 2>> edges;  // length / field, height
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const WorldPoint a = mesh.vertices[t[i]], b = mesh.vertices[t[(i + 1) % 3]], middle = 0.5 * (a + b);
      edges.push_back({length(b - a) / rising(middle), middle.z});
    }
  EdgeErrors out;
  for (const auto& e : edges) out.factor += e[0] / double(edges.size());
  double low = 0, high = 0;
  for (const auto& e : edges) {
    const double part = e[0] / out.factor;
    out.mean += std::abs(part - 1) / double(edges.size());
    if (e[1] < -.5) out.bottom += part, ++low;
    if (e[1] > .5) out.top += part, ++high;
  }
  out.bottom /= low;
  out.top /= high;
  return out;
}

void check_follows(const TriangleMesh& mesh) {
  const EdgeErrors errors = edge_errors(mesh);
  CHECK(errors.mean < .1);
  CHECK(std::abs(errors.bottom - 1) < .08);
  CHECK(std::abs(errors.top - 1) < .08);
}

/// How far triangles reach to the other side of the plane x = 0.
double farthest_across_seam(const TriangleMesh& mesh) {
  double over = 0;
  for (const auto& t : mesh.triangles) {
    double left = 0, right = 0;
    for (const uint32_t v : t) left = std::min(left, mesh.vertices[v].x), right = std::max(right, mesh.vertices[v].x);
    over = std::max(over, std::min(-left, right));
  }
  return over;
}

/// What the faces enclose, from the origin.
double volume(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles)
    sum += dot(mesh.vertices[t[0]], cross(mesh.vertices[t[1]], mesh.vertices[t[2]])) / 6;
  return sum;
}

/// Largest distance from the surface of the disc, of vertices and middles of faces.
double largest_distance_from_disc(const TriangleMesh& mesh) {
  double largest = 0;
  const auto look = [&](const WorldPoint& p) {
    const double r = std::sqrt(p.y * p.y + p.z * p.z);
    largest = std::max(largest, std::min(std::abs(1 - r), std::abs(kThick - std::abs(p.x))));
  };
  for (const WorldPoint& p : mesh.vertices) look(p);
  for (const auto& t : mesh.triangles)
    look((1. / 3) * (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]));
  return largest;
}

/// Largest distance of a vertex from the surface of the cube.
double largest_distance_from_cube(const TriangleMesh& mesh) {
  double largest = 0;
  for (const WorldPoint& p : mesh.vertices)
    largest = std::max(largest, std::abs(1 - std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)})));
  return largest;
}

}  // namespace

TEST_CASE("sized parts: edges of a cube follow a field in both directions, and its creases stay", "[sizing]") {
  const RemeshResult result = meshed(cube(), with_field(1500));
  CHECK(result.mesh.vertices.size() == 1500);
  CHECK(result.report.features.kept);
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(std::abs(volume(result.mesh) - 8) < .001);  // an edge that is rounded off takes part of it
  check_follows(result.mesh);
  CHECK(result.report.sizing.varies);
  CHECK(result.report.sizing.edge_error_mean < .1);
}

TEST_CASE("sized parts: a field alone has its own lengths, and decides how many vertices there are", "[sizing]") {
  const RemeshResult result = meshed(cube(), with_field({}));
  CHECK(result.report.features.kept);
  CHECK(std::abs(edge_errors(result.mesh).factor - 1) < .03);
  check_follows(result.mesh);
  // Of both squares at the ends, and of the sides, over 2 / sqrt(3) l^2 with l linear from .05 to .2 along them.
  const double vertices = 2 / std::sqrt(3.) * (4 / (.05 * .05) + 4 / (.2 * .2) + 8 * 2 / (.05 * .2));
  CHECK(std::abs(double(result.mesh.vertices.size()) / vertices - 1) < .1);
}

TEST_CASE("sized parts: borders that are kept have the lengths of a field", "[sizing][borders]") {
  for (const std::optional<int64_t> vertices : {std::optional<int64_t>(600), std::optional<int64_t>()}) {
    RemeshOptions options = with_field(vertices);
    options.boundary = Boundary::keep;
    options.closing_vox = 0;
    const RemeshResult result = meshed(square(24), options);
    if (vertices) CHECK(int64_t(result.mesh.vertices.size()) == *vertices);
    CHECK(result.report.features.kept);
    CHECK(check_mesh(result.mesh).boundary_loops == 1);
    check_follows(result.mesh);
  }
}

TEST_CASE("sized parts: a surface that is cut along seams alone has the lengths of a field", "[sizing][seams]") {
  const TriangleSoup soup = slab_with_seam();
  RemeshOptions options = with_field(1200);
  options.features.creases = Features::Creases::off;
  const RemeshResult result = meshed(soup, options);
  CHECK(result.mesh.vertices.size() == 1200);
  CHECK(result.report.features.seams > 0);
  CHECK(result.report.features.kept);
  CHECK(farthest_across_seam(result.mesh) < .005);
  CHECK(result.report.sizing.edge_error_mean < .12);
}

TEST_CASE("sized parts: adaptivity brings a disc's rim nearer, between its creases", "[sizing]") {
  double largest[2];
  for (const int adaptivity : {0, 1}) {
    RemeshOptions options;
    options.vertices = 700;
    options.adaptivity = adaptivity;
    const RemeshResult result = meshed(disc(256), options);
    CHECK(result.mesh.vertices.size() == 700);
    CHECK(result.report.features.kept);
    largest[adaptivity] = largest_distance_from_disc(result.mesh);
  }
  CHECK(largest[1] < .8 * largest[0]);
}

TEST_CASE("sized parts: on planes adaptivity finds nothing to shorten edges for", "[sizing]") {
  RemeshOptions options;
  options.vertices = 500;
  const RemeshResult even = meshed(cube(), options);
  options.adaptivity = 1;
  const RemeshResult adapted = meshed(cube(), options);
  CHECK(adapted.report.features.kept);
  CHECK(adapted.mesh.vertices.size() == 500);
  CHECK(std::abs(volume(adapted.mesh) - 8) < .001);
  CHECK(adapted.report.optimize.self_intersections == even.report.optimize.self_intersections);
}

TEST_CASE("sized parts: both fits and even areas keep creases and the count", "[sizing][features]") {
  for (const Fit fit : {Fit::balanced, Fit::surface})
    for (const bool uniform_area : {false, true})
      for (const bool sized : {false, true}) {
        RemeshOptions options;
        if (sized) options = with_field({});
        options.vertices = 700;
        options.fit = fit;
        options.uniform_area = uniform_area;
        const RemeshResult result = meshed(cube(), options);
        CHECK(result.mesh.vertices.size() == 700);
        CHECK(result.report.features.kept);
        CHECK(result.report.optimize.self_intersections == 0);
        CHECK(largest_distance_from_cube(result.mesh) < .1 * result.report.grid.frame.voxel_size);
        CHECK(std::abs(volume(result.mesh) - 8) < .002);  // a balanced fit takes vertices a few steps off planes
      }
}

TEST_CASE("sized parts: both fits, even areas and adaptivity keep borders and seams", "[sizing][borders][seams]") {
  for (const Fit fit : {Fit::balanced, Fit::surface})
    for (const bool uniform_area : {false, true})
      for (const int adaptivity : {0, 1}) {
        RemeshOptions options;
        options.vertices = 600;
        options.fit = fit;
        options.uniform_area = uniform_area;
        options.adaptivity = adaptivity;
        options.features.creases = Features::Creases::off;
        const RemeshResult slab = meshed(slab_with_seam(), options);
        CHECK(slab.mesh.vertices.size() == 600);
        CHECK(slab.report.features.kept);
        CHECK(slab.report.optimize.self_intersections == 0);
        CHECK(farthest_across_seam(slab.mesh) < .005);
        options.boundary = Boundary::keep;
        options.closing_vox = 0;
        const RemeshResult open = meshed(square(24), options);
        CHECK(open.mesh.vertices.size() == 600);
        CHECK(open.report.features.kept);
        CHECK(open.report.optimize.self_intersections == 0);
        CHECK(check_mesh(open.mesh).boundary_loops == 1);
        double area = 0;
        for (const auto& t : open.mesh.triangles)
          area += triangle_area(open.mesh.vertices[t[0]], open.mesh.vertices[t[1]], open.mesh.vertices[t[2]]);
        CHECK(std::abs(area - 4) < .002);  // a rim that is rounded off takes part of it
      }
}
