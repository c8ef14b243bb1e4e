// Polygons and dense arrays of values in memory: the surfaces that files of the same would give.
#include <cmath>
#include <limits>
#include <vector>

#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/run/run.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

/// A cube of five quads and two triangles.
PolygonSoup cube() {
  PolygonSoup soup;
  for (int i = 0; i < 8; ++i) soup.vertices.push_back({double(i & 1), double(i >> 1 & 1), double(i >> 2)});
  soup.sizes = {4, 4, 4, 4, 4, 3, 3};
  soup.corners = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 1, 7, 5};
  return soup;
}

std::string text_of(const PolygonSoup& soup) {
  std::string text;
  for (const WorldPoint& p : soup.vertices)
    text += "v " + std::to_string(p.x) + " " + std::to_string(p.y) + " " + std::to_string(p.z) + "\n";
  size_t corner = 0;
  for (const uint32_t size : soup.sizes) {
    text += "f";
    for (uint32_t i = 0; i < size; ++i) text += " " + std::to_string(soup.corners[corner++] + 1);
    text += "\n";
  }
  return text;
}

/// Distances from a ball of radius 6.3 around the middle of an array of n^3, z fastest.
std::vector<float> ball_values(int64_t n) {
  std::vector<float> values;
  const double middle = double(n - 1) / 2;
  for (int64_t x = 0; x < n; ++x)
    for (int64_t y = 0; y < n; ++y)
      for (int64_t z = 0; z < n; ++z)
        values.push_back(float(std::hypot(double(x) - middle, double(y) - middle, double(z) - middle) - 6.3));
  return values;
}

DenseVolume volume_of(const std::vector<float>& values, int64_t n) { return {values.data(), {n, n, n}, {n * n, n, 1}}; }

TriangleSoup surface(const DenseVolume& volume, std::optional<double> iso = {}) {
  VolumeInfo info;
  return surface_of_volume(volume, "mine", {"", iso, 0, VolumeCreases::none}, info);
}

bool is_closed(const TriangleSoup& soup) {
  return check_mesh(TriangleMesh{soup.vertices, soup.triangles}).is_closed_manifold();
}

}  // namespace

TEST_CASE("memory: polygons become the triangles that a file of them becomes", "[memory_input]") {
  const TemporaryFolder folder;
  put_file(folder / "cube.obj", text_of(cube()));
  const TriangleSoup read = read_mesh(folder / "cube.obj"), made = split_polygons(cube(), "mine");
  CHECK(made.triangles == read.triangles);
  CHECK(made.faces_in_file == 7);
}

TEST_CASE("memory: polygons that do not fit their vertices or sizes are refused by the face", "[memory_input]") {
  PolygonSoup soup = cube();
  soup.corners[5] = 8;
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { split_polygons(soup, "mine"); }),
                 "mine: face 1 has vertex 8"));
  soup = cube();
  soup.sizes.back() = 4;
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { split_polygons(soup, "mine"); }), "face 6 ends behind"));
  soup.sizes.pop_back();
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { split_polygons(soup, "mine"); }), "23 corners, and 26"));
  CHECK(contains(message_of(ErrorCode::nothing_to_mesh, [&] { split_polygons({}, "mine"); }), "mine"));
}

TEST_CASE("memory: the surface of an array is where its values are", "[memory_input]") {
  const int64_t n = 20;
  const std::vector<float> values = ball_values(n);
  DenseVolume volume = volume_of(values, n);
  volume.step_world = {WorldPoint{1, 0, 0}, {0, 2, 0}, {0, 0, 0.5}};
  volume.origin_world = {10, -20, 30};
  const TriangleSoup soup = surface(volume);
  CHECK(is_closed(soup));
  CHECK(isoshell::volume(soup) > 0);
  for (const WorldPoint& p : soup.vertices)
    CHECK(std::hypot(p.x - 10 - 9.5, (p.y + 20) / 2 - 9.5, (p.z - 30) * 2 - 9.5) == Approx(6.3).margin(0.1));
}

TEST_CASE("memory: steps that turn, skew and mirror an array move its surface, which stays turned outward",
          "[memory_input]") {
  const int64_t n = 20;
  const std::vector<float> values = ball_values(n);
  DenseVolume volume = volume_of(values, n);
  const TriangleSoup straight = surface(volume);
  volume.step_world = {WorldPoint{-1, .25, .5}, {.5, 2, 0}, {.25, -.5, 1}};
  volume.origin_world = {10, -20, 30};
  TriangleSoup moved = surface(volume);
  CHECK(is_closed(moved));
  const auto& [x, y, z] = volume.step_world;
  const double det = dot(x, cross(y, z));
  REQUIRE(det < 0);
  CHECK(isoshell::volume(moved) == Approx(-det * isoshell::volume(straight)));
  REQUIRE(moved.vertices.size() == straight.vertices.size());
  for (size_t v = 0; v < moved.vertices.size(); ++v) {
    const WorldPoint& p = straight.vertices[v];
    REQUIRE(length(moved.vertices[v] - (volume.origin_world + p.x * x + p.y * y + p.z * z)) < 1e-12);
  }
  for (auto& corners : moved.triangles) std::swap(corners[1], corners[2]);
  CHECK(moved.triangles == straight.triangles);
}

TEST_CASE("memory: strides say the order of the axes", "[memory_input]") {
  const int64_t n = 20;
  std::vector<float> values = ball_values(n), turned(values.size());
  for (int64_t x = 0; x < n; ++x) values[size_t(x)] += 0.001f * float(x);  // no longer the same from all sides
  for (int64_t i = 0; i < n * n * n; ++i) turned[size_t(i % n * n * n + i / n % n * n + i / n / n)] = values[size_t(i)];
  DenseVolume volume = volume_of(turned, n);
  std::swap(volume.stride[0], volume.stride[2]);
  CHECK(surface(volume, 0).triangles == surface(volume_of(values, n), 0).triangles);
}

TEST_CASE("memory: outside is the side of the isovalue that most of the array's faces lie on", "[memory_input]") {
  const int64_t n = 20;
  std::vector<float> values = ball_values(n), dense;
  for (const float v : values) dense.push_back(-v);
  const double inner = volume(surface(volume_of(values, n), -1));
  CHECK(inner == Approx(4. / 3 * std::acos(-1) * 5.3 * 5.3 * 5.3).epsilon(0.04));
  CHECK(volume(surface(volume_of(dense, n), 1)) == Approx(inner).epsilon(1e-6));
}

TEST_CASE("memory: blocks of one value cost nothing and change nothing", "[memory_input]") {
  const int64_t n = 40;
  std::vector<float> mask, noisy;
  for (const float v : ball_values(n)) {
    mask.push_back(v < 0 ? 1.f : 0.f);
    noisy.push_back(mask.back());
  }
  noisy[0] = 0.25f;  // its block is no tile now
  CHECK(surface(volume_of(mask, n), 0.5).triangles == surface(volume_of(noisy, n), 0.5).triangles);
}

TEST_CASE("memory: an array without a surface is refused", "[memory_input]") {
  std::vector<float> values(27, 1);
  DenseVolume volume = volume_of(values, 3);
  CHECK(contains(message_of(ErrorCode::nothing_to_mesh, [&] { surface(volume, 0); }), "no surface"));
  values[14] = std::numeric_limits<float>::infinity();
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { surface(volume, 0); }),
                 "mine: value (1, 1, 2) is inf; values must be finite, or NaN where nothing is known"));
  std::fill(values.begin(), values.end(), std::numeric_limits<float>::quiet_NaN());
  CHECK(
      contains(message_of(ErrorCode::nothing_to_mesh, [&] { surface(volume, 0); }), "none of its values is a number"));
  volume.step_world[1] = {2, 0, 1};
  CHECK(contains(message_of(ErrorCode::usage, [&] { surface(volume, 0); }), "span no volume"));
  volume = volume_of(values, 3);
  volume.size[1] = 0;
  CHECK(contains(message_of(ErrorCode::usage, [&] { surface(volume, 0); }), "0 values along an axis"));
}

TEST_CASE("memory: points of a program are refused where they are not finite", "[memory_input]") {
  PointCloud cloud;
  cloud.position = cube().vertices;
  cloud.position[3].y = std::numeric_limits<double>::quiet_NaN();
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { input_of(cloud, "mine", 0); }), "mine: point 3 is"));
  cloud.position[3].y = 0;
  cloud.normal = {{0, 0, 1}};
  CHECK(contains(message_of(ErrorCode::usage, [&] { input_of(cloud, "mine", 0); }), "1 normals and 8 points"));
}

TEST_CASE("memory: what a run would take is the same from a file and from memory", "[memory_input]") {
  const TemporaryFolder folder;
  put_file(folder / "cube.obj", text_of(cube()));
  RunRequest request;
  Context context;
  const RunEstimate made = dry_run(input_of(split_polygons(cube(), "mine"), "mine"), request, context);
  request.input = named_input(folder / "cube.obj");
  const RunEstimate read = dry_run(request, context);
  CHECK(made.bytes == read.bytes);
  CHECK(made.sites == read.sites);
}
