// Level sets that runs write: of a fog volume, of points, of their results, and with values of 16 bits.
#include <openvdb/openvdb.h>

#include <cmath>
#include <filesystem>

#include "geometry/box.h"
#include "geometry/triangle_search.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/each_voxel.h"
#include "isoshell/run/run.h"
#include "isoshell/run/steps.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/temporary_file.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

constexpr double kRadius = 1;
const WorldPoint kMiddle{1, 2, 3};

double from_ball(double x, double y, double z) {
  return std::sqrt((x - kMiddle.x) * (x - kMiddle.x) + (y - kMiddle.y) * (y - kMiddle.y) +
                   (z - kMiddle.z) * (z - kMiddle.z)) -
         kRadius;
}

RunRequest request_of(int64_t vertices, int32_t resolution) {
  RunRequest request;
  request.options.values.vertices = vertices;
  request.options.values.resolution = resolution;
  request.options.given = {"vertices", "resolution"};
  request.overwrite = true;
  return request;
}

openvdb::FloatGrid::Ptr read_surface(const std::string& path) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open();
  return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("surface"));
}

constexpr double kHalfEpsilon = 1. / 2048;  // of numbers of 16 bits

/// What every program expects of a level set of the ball, whose distances are right to so many of its voxels.
void check_ball(const openvdb::FloatGrid& grid, double band_vox, double within_vox) {
  const double voxel = grid.voxelSize()[0];
  CHECK(grid.getGridClass() == openvdb::GRID_LEVEL_SET);
  CHECK(double(grid.background()) == Approx(band_vox * voxel).epsilon(kHalfEpsilon));
  CHECK(grid.tree().activeTileCount() == 0);
  for (auto it = grid.cbeginValueOn(); it; ++it) {
    const openvdb::Vec3d p = grid.indexToWorld(it.getCoord());
    REQUIRE(std::abs(*it) <= grid.background());
    REQUIRE(double(*it) == Approx(from_ball(p[0], p[1], p[2])).margin(within_vox * voxel));
  }
  const auto values = grid.getConstAccessor();
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  for (auto at = openvdb::CoordBBox(box.min().offsetBy(-3), box.max().offsetBy(3)).beginXYZ(); at; ++at) {
    const openvdb::Vec3d p = grid.indexToWorld(*at);
    const double exact = from_ball(p[0], p[1], p[2]);
    if (std::abs(exact) > within_vox * voxel) REQUIRE((values.getValue(*at) < 0) == (exact < 0));
    if (std::abs(exact) < (band_vox - within_vox) * voxel) REQUIRE(values.isValueOn(*at));
  }
}

/// Dense inside, in steps of .05, with a soft border of three of them.
void write_fog(const std::string& path) {
  openvdb::initialize();
  constexpr double kStep = .05;
  const auto grid = openvdb::FloatGrid::create(0);
  grid->setName("density");
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(kStep));
  auto values = grid->getAccessor();
  for (auto at = openvdb::CoordBBox({-5, 15, 35}, {45, 65, 85}).beginXYZ(); at; ++at) {
    const openvdb::Vec3d p = grid->indexToWorld(*at);
    const double density = std::min(1., .5 - from_ball(p[0], p[1], p[2]) / (3 * kStep));
    if (density > 0) values.setValue(*at, float(density));
  }
  openvdb::io::File(path).write({grid});
}

PointCloud points_of_ball(int count) {
  PointCloud cloud;
  for (int i = 0; i < count; ++i) {
    const double turn = 2.399963229728653 * i, z = 1 - (2 * i + 1.) / count, r = std::sqrt(1 - z * z);
    cloud.position.push_back({kMiddle.x + r * std::cos(turn), kMiddle.y + r * std::sin(turn), kMiddle.z + z});
  }
  return cloud;
}

double distance_to(const TriangleMesh& mesh, WorldPoint p) {
  double least_sq = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles)
    least_sq = std::min(
        least_sq, nearest_of_triangle(p, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]).distance_sq);
  return std::sqrt(least_sq);
}

/// Of a mesh all of which is seen from the ball's middle: by the triangle that is seen where the place is.
bool is_inside(const TriangleMesh& mesh, WorldPoint p) {
  const WorldPoint to = p - kMiddle;
  for (const auto& t : mesh.triangles) {
    const WorldPoint a = mesh.vertices[t[0]] - kMiddle, b = mesh.vertices[t[1]] - kMiddle,
                     c = mesh.vertices[t[2]] - kMiddle;
    const double volume = dot(a, cross(b, c)), in_a = dot(to, cross(b, c)) / volume,
                 in_b = dot(to, cross(c, a)) / volume, in_c = dot(to, cross(a, b)) / volume;
    if (in_a >= 0 && in_b >= 0 && in_c >= 0) return in_a + in_b + in_c < 1;
  }
  return false;
}

WorldPoint centre_of(const LevelSet& set, Voxel v) {
  const LatticeFrame& f = set.frame;
  return {f.origin.x + (v.x + .5) * f.voxel_size, f.origin.y + (v.y + .5) * f.voxel_size,
          f.origin.z + (v.z + .5) * f.voxel_size};
}

/// The mesh and the level set of either, in memory.
RunResult run_with_level_set_of(const TriangleSoup& soup, LevelSetOf of, RunRequest request) {
  request.level_set.of = of;
  request.level_set.keep = true;
  TestContext context;
  return run(input_of(soup, "shape"), request, context);
}

}  // namespace

TEST_CASE("level set of a run: that of a fog volume has the sign of its density", "[level_set][volume]") {
  const TemporaryFile fog("fog.vdb"), file("set.vdb");
  write_fog(fog.path);
  RunRequest request = request_of(300, 60);
  request.input.path = fog.path;
  request.input.iso = .5;
  request.level_set.path = file.path;
  request.level_set.band_vox = 4;
  TestContext context;
  CHECK(run(request, context).record.input.kind == InputKind::volume);
  check_ball(*read_surface(file.path), 4, .2);
}

TEST_CASE("level set of a run: that of a cloud is around the surface that its points lie on", "[level_set][volume]") {
  const TemporaryFile file("set.vdb");
  for (const StopAfter stop : {StopAfter::mesh, StopAfter::level_set}) {
    RunRequest request = request_of(300, 60);
    request.stop_after = stop;
    (stop == StopAfter::mesh ? request.level_set.path : request.output.path) = file.path;
    TestContext context;
    CHECK(run(input_of(points_of_ball(4000), "points", 0), request, context).record.input.kind == InputKind::points);
    check_ball(*read_surface(file.path), 3, .3);
  }
}

TEST_CASE("level set of a run: halves take half of the file and are as near as 16 bits allow", "[level_set][volume]") {
  const TemporaryFile single("single.vdb"), halves("halves.vdb");
  const TriangleSoup ball = shapes::sphere(kMiddle, kRadius, 96);
  for (const bool as_half : {false, true}) {
    RunRequest request = request_of(300, 60);
    request.level_set.path = as_half ? halves.path : single.path;
    request.level_set.as_half = as_half;
    TestContext context;
    run(input_of(ball, "ball"), request, context);
    const openvdb::FloatGrid::Ptr grid = read_surface(request.level_set.path);
    CHECK(grid->saveFloatAsHalf() == as_half);
    check_ball(*grid, 3, .1);
  }
  CHECK(double(std::filesystem::file_size(halves.path)) < .75 * double(std::filesystem::file_size(single.path)));
}

TEST_CASE("level set of a run: that of the result is exact to its triangles, in the input's voxels", "[level_set]") {
  const TriangleSoup ball = shapes::sphere(kMiddle, kRadius, 48);
  const RunRequest request = request_of(60, 64);  // far from the ball between its vertices
  const RunResult of_input = run_with_level_set_of(ball, LevelSetOf::input, request),
                  of_result = run_with_level_set_of(ball, LevelSetOf::result, request);
  CHECK(of_input.mesh.vertices.size() == of_result.mesh.vertices.size());
  const LevelSet& set = *of_result.level_set;
  REQUIRE(set.distance_vox.size() > 10000);
  const double voxel = set.frame.voxel_size;
  CHECK(voxel == of_input.level_set->frame.voxel_size);
  const double shift_vox = (set.frame.origin.x - of_input.level_set->frame.origin.x) / voxel;
  CHECK(shift_vox == Approx(std::round(shift_vox)).margin(1e-9));
  double least = 0;
  for_each_voxel(set.voxels, [&](Voxel v, int64_t i) {
    const double distance = double(set.distance_vox[i]) * voxel;
    least = std::min(least, distance);
    if (i % 7 != 0) return;
    const WorldPoint p = centre_of(set, v);
    const double exact = distance_to(of_result.mesh, p);
    REQUIRE(std::abs(distance) == Approx(exact).margin(1e-6));
    if (exact > 1e-6) REQUIRE((distance < 0) == is_inside(of_result.mesh, p));
  });
  CHECK(least < -2.5 * voxel);
}

TEST_CASE("level set of a run: those of one voxel size have the same voxels, as OpenVDB makes them, and are united",
          "[level_set]") {
  constexpr double kVoxel = .05;
  const TemporaryFile files[] = {TemporaryFile("left.vdb"), TemporaryFile("right.vdb")};
  const WorldPoint middles[] = {kMiddle, {kMiddle.x + 1.1, kMiddle.y - .013, kMiddle.z}};
  for (const size_t i : {size_t(0), size_t(1)}) {
    RunRequest request = request_of(300, 0);
    request.options.values.resolution.reset();
    request.options.given = {"vertices", "voxel-size"};
    request.options.values.voxel_size_world = kVoxel;
    request.level_set.path = files[i].path;
    TestContext context;
    run(input_of(shapes::sphere(middles[i], kRadius, 32), "shape"), request, context);
    const openvdb::FloatGrid::Ptr grid = read_surface(files[i].path);
    CHECK(grid->transform() == *openvdb::math::Transform::createLinearTransform(kVoxel));
    const openvdb::Vec3d top = grid->worldToIndex({middles[i].x, middles[i].y, middles[i].z + kRadius});
    CHECK(std::abs(double(grid->tree().getValue(openvdb::Coord::round(top)))) < kVoxel);
  }
  InputRequest both;
  both.path = files[0].path;
  both.also = {files[1].path};
  both.unite = true;
  const Input united = read_input(both, 0);
  const WorldBox box = box_of(united.soup.vertices);
  CHECK(box.min.x == Approx(kMiddle.x - kRadius).margin(.1 * kVoxel));
  CHECK(box.max.x == Approx(middles[1].x + kRadius).margin(.1 * kVoxel));
}

TEST_CASE("level set of a run: that of a hollow result is positive in the hollow", "[level_set]") {
  TriangleSoup ball = shapes::sphere(kMiddle, 1, 48);
  const TriangleSoup hollow = shapes::inside_out(shapes::sphere(kMiddle, .5, 48));
  const RunResult made = run_with_level_set_of(shapes::together(ball, hollow), LevelSetOf::result, request_of(800, 64));
  const LevelSet& set = *made.level_set;
  int64_t in_hollow = 0;
  for_each_voxel(set.voxels, [&](Voxel v, int64_t i) {
    const WorldPoint p = centre_of(set, v);
    const double radius = from_ball(p.x, p.y, p.z) + kRadius;
    const double exact = radius < .75 ? .5 - radius : radius - 1;
    if (std::abs(exact) > set.frame.voxel_size) REQUIRE((set.distance_vox[i] < 0) == (exact < 0));
    in_hollow += radius < .45 ? 1 : 0;
  });
  CHECK(in_hollow > 1000);
}

TEST_CASE("level set of a run: where that of the result cannot be, no file is written", "[level_set]") {
  TemporaryFile mesh("mesh.ply"), set("set.vdb");
  RunRequest request = request_of(60, 40);
  request.output = named_output(mesh.path, "", StopAfter::mesh);
  request.level_set.path = set.path;
  request.level_set.as_half = true;
  for (const LevelSetOf of : {LevelSetOf::result, LevelSetOf::input}) {
    request.level_set.of = of;
    TestContext context;
    const Error error = error_of([&] { run(input_of(shapes::sphere(kMiddle, 1e-6, 24), "ball"), request, context); });
    CHECK(says(error, "leave out --level-set-half"));
    CHECK_FALSE(std::filesystem::exists(mesh.path));
  }
}

TEST_CASE("level set of a run: options of one that is not asked for are refused", "[level_set]") {
  RunRequest request = request_of(60, 40);
  request.level_set.as_half = true;
  CHECK(says(error_of([&] { RunSteps{request}; }), "--level-set-half is of a level set, and none is asked for"));
  request.level_set = {};
  request.level_set.of = LevelSetOf::result;
  CHECK(says(error_of([&] { RunSteps{request}; }), "--level-set-of is of a level set"));
  request.level_set.keep = true;
  RunSteps{request};
}

TEST_CASE("level set of a run: what has no result with an inside is refused before it begins", "[level_set]") {
  const TriangleSoup ball = shapes::sphere(kMiddle, kRadius, 24);
  const auto refusal = [&](auto change) {
    RunRequest request = request_of(60, 40);
    request.level_set.of = LevelSetOf::result;
    request.level_set.keep = true;
    change(request);
    TestContext context;
    return error_of([&] { run(input_of(ball, "ball"), request, context); });
  };
  CHECK(says(refusal([](RunRequest& r) { r.stop_after = StopAfter::level_set; }), "leave out --stop-after"));
  CHECK(says(refusal([](RunRequest& r) { r.options.values.boundary = Boundary::keep; }), "leave out --boundary keep"));
  CHECK(says(refusal([](RunRequest& r) { r.options.values.regions = "components"; }), "of one solid"));
}
