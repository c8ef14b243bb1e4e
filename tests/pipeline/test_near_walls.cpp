// Parts that are nearer to one another than edges of the result can follow: never an intersection.
#include <cmath>

#include "isoshell/isoshell.h"
#include "isoshell/mesh_topology.h"
#include "measure/crossing_corners.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

DualMesh mesh_of(const std::vector<PointQ8>& position, const std::vector<TriangleIndices>& triangles) {
  DualMesh mesh;
  mesh.position = Buffer<PointQ8>(int64_t(position.size()));
  mesh.triangles = Buffer<TriangleIndices>(int64_t(triangles.size()));
  std::copy(position.begin(), position.end(), mesh.position.begin());
  std::copy(triangles.begin(), triangles.end(), mesh.triangles.begin());
  return mesh;
}

/// A square around the z axis.
TriangleSoup square(double half_side, double z) {
  TriangleSoup soup;
  soup.vertices = {
      {-half_side, -half_side, z}, {half_side, -half_side, z}, {half_side, half_side, z}, {-half_side, half_side, z}};
  soup.triangles = {{0, 1, 2}, {0, 2, 3}};
  return soup;
}

RemeshResult remeshed(const TriangleSoup& soup, int32_t resolution, int64_t vertices) {
  RemeshOptions options;
  options.resolution = resolution;
  options.vertices = vertices;
  options.features.creases = Features::Creases::off;  // plates that keep theirs need no voxels
  TestContext context;
  RemeshResult result = remesh(soup, options, context);
  CHECK(check_mesh(result.mesh).is_closed_manifold());
  CHECK(int64_t(result.mesh.vertices.size()) == vertices);
  CHECK(result.report.is_optimized);
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK_FALSE(result.report.intersection_at);
  return result;
}

bool warns_of(const RemeshReport& report, const std::string& what) {
  for (const std::string& text : report.warnings)
    if (text.find(what) != std::string::npos) return true;
  return false;
}

}  // namespace

TEST_CASE("near walls: corners of triangles that cross are found, whoever else touches them", "[near]") {
  const std::vector<PointQ8> position{{0, 0, 0},          {1000, 0, 0},    {0, 1000, 0},       {200, 200, -500},
                                      {210, 220, 500},    {230, 200, 700}, {5000, 5000, 5000}, {6000, 5000, 5000},
                                      {5000, 6000, 5000}, {1000, 1000, 0}};
  const std::vector<TriangleIndices> triangles{{0, 1, 2}, {3, 4, 5}, {6, 7, 8}, {1, 9, 2}};
  const std::vector<PointQ8> crossing = crossing_corners(mesh_of(position, triangles), {});
  const std::vector<PointQ8> expected{position[0], position[2], position[3], position[4], position[5], position[1]};
  CHECK(crossing == expected);
  CHECK(crossing_corners(mesh_of(position, {{0, 1, 2}, {1, 9, 2}, {6, 7, 8}}), {}).empty());
}

TEST_CASE("near walls: copies of one place do not cross", "[near]") {
  const std::vector<PointQ8> position{{0, 0, 0}, {1000, 0, 0}, {0, 1000, 0}, {0, 0, 0}, {1000, 0, 0}, {0, 0, 1000}};
  const DualMesh mesh = mesh_of(position, {{0, 1, 2}, {3, 4, 5}});
  CHECK(crossing_corners(mesh, {}).size() == 4);
  const std::vector<uint32_t> joined{0, 1, 2, 0, 1, 5};
  CHECK(crossing_corners(mesh, {joined.data(), 6}).empty());
}

TEST_CASE("near walls: thin plates a hair apart stay apart", "[near]") {
  TriangleSoup plates;
  for (const double z : {0., .013, .026}) plates = shapes::together(plates, shapes::box({0, 0, z}, {1, .7, z + .003}));
  const RemeshResult result = remeshed(plates, 200, 200);
  CHECK(check_mesh(result.mesh).components == 3);
  CHECK(result.report.sheet.agrees);
  CHECK(warns_of(result.report, "vertices edges were collapsed"));
}

TEST_CASE("near walls: open squares, one close above another, give no intersection", "[near]") {
  const TriangleSoup squares = shapes::together(shapes::together(square(1, 0), square(.6, -.01)), square(.3, -.02));
  remeshed(squares, 64, 300);
}

TEST_CASE("near walls: plates with room between them are relaxed", "[near]") {
  const TriangleSoup plates =
      shapes::together(shapes::box({0, 0, 0}, {1, .7, .1}), shapes::box({0, 0, .3}, {1, .7, .4}));
  const RemeshReport report = remeshed(plates, 64, 800).report;
  CHECK_FALSE(warns_of(report, "collapsed"));
  CHECK(report.sheet.topology.components == 2);
}
