// Unsigned distances as input: one skin where they are 0, and what is no distance says so.
#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/MeshToVolume.h>
#include <tbb/global_control.h>

#include <cmath>
#include <functional>
#include <limits>

#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "isoshell/io/volume_file.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/temporary_file.h"

using namespace isoshell;

namespace {

using Distance = std::function<double(const openvdb::Vec3d&)>;  // in world units

struct Sampling {
  double voxel = 1, half_width_vox = 3;
  int reach_vox = 24;  // of the cube that is sampled around the origin
};

openvdb::FloatGrid::Ptr sample(const Distance& distance, const Sampling& how = {}) {
  const double background = how.half_width_vox * how.voxel;
  auto grid = openvdb::FloatGrid::create(float(background));
  grid->setTransform(openvdb::math::Transform::createLinearTransform(how.voxel));
  grid->setName("udf");
  auto to = grid->getAccessor();
  for (int x = -how.reach_vox; x <= how.reach_vox; ++x)
    for (int y = -how.reach_vox; y <= how.reach_vox; ++y)
      for (int z = -how.reach_vox; z <= how.reach_vox; ++z) {
        const double d = distance(openvdb::Vec3d(x, y, z) * how.voxel);
        if (d < background) to.setValue({x, y, z}, float(d));
      }
  return grid;
}

const openvdb::Vec3d kCentre(0.3, -0.2, 0.45);

Distance sphere(double radius) {
  return [=](const openvdb::Vec3d& p) { return std::abs((p - kCentre).length() - radius); };
}

/// The surface of a box of so many units along each axis, around a middle.
Distance box(const openvdb::Vec3d& size, const openvdb::Vec3d& middle) {
  return [=](const openvdb::Vec3d& p) {
    openvdb::Vec3d out(0.0);
    double nearest_face = -1e9;
    for (int i = 0; i < 3; ++i) {
      const double beyond = std::abs(p[i] - middle[i]) - size[i] / 2;
      out[i] = std::max(beyond, 0.0);
      nearest_face = std::max(nearest_face, beyond);
    }
    return nearest_face < 0 ? -nearest_face : out.length();
  };
}

struct Read {
  TriangleSoup soup;
  VolumeInfo info;
  InputTopology topology;
};

Read read(const openvdb::GridBase::Ptr& grid, const VolumeReadOptions& options = {}) {
  const TemporaryFile file("udf.vdb");
  openvdb::io::File(file.path).write({grid});
  Read result;
  result.soup = read_volume(file.path, options, result.info);
  Context context;
  result.topology = measure_topology(result.soup, context).topology;
  return result;
}

std::string refusal(const openvdb::GridBase::Ptr& grid, ErrorCode code) {
  return message_of(code, [&] { read(grid); });
}

bool is_one_ball(const Read& read) {
  return read.topology.closed && read.topology.oriented && read.topology.components == 1 && read.topology.genus == 0;
}

/// Largest distance of a vertex from the zero set.
double distance_of(const TriangleSoup& soup, const Distance& distance) {
  double worst = 0;
  for (const WorldPoint& p : soup.vertices) worst = std::max(worst, distance({p.x, p.y, p.z}));
  return worst;
}

}  // namespace

TEST_CASE("unsigned volume: a sphere is one skin in bands of any width and voxels of any size", "[volume][stage]") {
  constexpr double kRadius = 15.3;
  for (const double half_width : {1.5, 3.0, 8.0})
    for (const double voxel : {0.01, 1.0, 25.0}) {
      INFO("half-width " << half_width << ", voxel " << voxel);
      const Distance scaled = [=](const openvdb::Vec3d& p) { return voxel * sphere(kRadius)(p / voxel); };
      const Read result = read(sample(scaled, {voxel, half_width, 24}));
      CHECK(result.info.kind == VolumeKind::unsigned_distance);
      CHECK(is_one_ball(result));
      CHECK(distance_of(result.soup, scaled) <
            voxel / kRadius);  // twice as far as an arc is from a chord of two voxels
      const double true_volume = 4.0 / 3 * 3.14159265358979 * std::pow(kRadius * voxel, 3);
      CHECK(volume(result.soup) == Approx(true_volume).epsilon(0.01));
    }
}

TEST_CASE("unsigned volume: distances in voxels, as a dense grid, or of a turned grid are taken too",
          "[volume][stage]") {
  const Distance ball = sphere(15.3);
  SECTION("in voxels") {
    const auto grid = sample(ball);
    grid->setTransform(openvdb::math::Transform::createLinearTransform(0.1));
    const Read result = read(grid);
    CHECK(is_one_ball(result));
    CHECK(distance_of(result.soup, [&](const openvdb::Vec3d& p) { return 0.1 * ball(p * 10); }) < 0.004);
  }
  SECTION("dense, with a background that nobody would reach") {
    const auto grid = sample(ball, {1, 1e6, 23});
    const Read result = read(grid);
    CHECK(is_one_ball(result));
    CHECK(distance_of(result.soup, ball) < 0.04);
  }
  SECTION("turned, mirrored and moved") {
    const auto grid = sample(ball);
    openvdb::math::Mat4d turn = openvdb::math::Mat4d::identity();
    turn.postRotate(openvdb::math::Y_AXIS, 0.7);
    turn.postScale(openvdb::Vec3d(-1, 1, 1));
    turn.postTranslate(openvdb::Vec3d(100, 0, -7));
    grid->transform().postMult(turn);
    const Read result = read(grid);
    CHECK(is_one_ball(result));
    CHECK(volume(result.soup) > 0);
    CHECK(distance_of(result.soup, [&](const openvdb::Vec3d& p) { return ball(turn.inverse().transform(p)); }) < 0.04);
  }
  SECTION("as doubles") {
    const auto grid = openvdb::DoubleGrid::create(3);
    const auto floats = sample(ball);
    for (auto value = floats->cbeginValueOn(); value; ++value) grid->tree().setValue(value.getCoord(), double(*value));
    CHECK(is_one_ball(read(grid)));
  }
}

TEST_CASE("unsigned volume: the space between two nested spheres is inside, what the inner one holds is not",
          "[volume][stage]") {
  const Distance both = [](const openvdb::Vec3d& p) { return std::min(sphere(20)(p), sphere(9)(p)); };
  for (const double half_width : {1.5, 3.0}) {
    const Read result = read(sample(both, {1, half_width, 26}));
    CHECK(result.topology.components == 2);
    CHECK(result.topology.closed);
    CHECK(distance_of(result.soup, both) < 0.06);
    CHECK(volume(result.soup) == Approx(4.0 / 3 * 3.14159265358979 * (8000 - 729)).epsilon(0.01));
  }
}

TEST_CASE("unsigned volume: a plate of two voxels is one skin where a lattice point lies well inside of it",
          "[volume][stage]") {
  for (const double at : {0.0, 0.125, 0.25, 0.375}) {
    INFO("middle at " << at);
    const Distance plate = box({30, 20, 2}, {0.2, 0.3, at});
    const Read result = read(sample(plate));
    CHECK(is_one_ball(result));
    CHECK(distance_of(result.soup, plate) < 0.87);  // its corners are cut, by half a voxel's diagonal at most
    CHECK(volume(result.soup) == Approx(30 * 20 * 2).epsilon(0.1));
  }
}

TEST_CASE("unsigned volume: a plate of two voxels halfway between lattice points is one skin around it at worst",
          "[volume][stage]") {
  for (const double at : {0.45, 0.5}) {
    const Distance plate = box({30, 20, 2}, {0.2, 0.3, at});
    const Read result = read(sample(plate));
    CHECK(is_one_ball(result));
    CHECK(distance_of(result.soup, plate) < 0.91);
  }
}

TEST_CASE("unsigned volume: a surface with missing faces is closed where they are", "[volume][stage]") {
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 20, 24);
  std::vector<openvdb::Vec3s> points;
  std::vector<openvdb::Vec3I> faces;
  for (const WorldPoint& p : ball.vertices) points.emplace_back(float(p.x), float(p.y), float(p.z));
  for (size_t t = 0; t < ball.triangles.size(); ++t)
    if (t % 50 != 7) faces.emplace_back(ball.triangles[t][0], ball.triangles[t][1], ball.triangles[t][2]);
  const auto transform = openvdb::math::Transform::createLinearTransform(1.0);
  for (const float half_width : {3.f, 8.f}) {
    const Read result = read(
        openvdb::tools::meshToUnsignedDistanceField<openvdb::FloatGrid>(*transform, points, faces, {}, half_width));
    CHECK(is_one_ball(result));
    CHECK(distance_of(result.soup, [](const openvdb::Vec3d& p) { return std::abs(p.length() - 20); }) < 1);
  }
}

TEST_CASE("unsigned volume: an open half of a sphere becomes the closed crust around it", "[volume][stage]") {
  const Distance half_sphere = [](const openvdb::Vec3d& p) {
    if (p.z() >= 0) return std::abs(p.length() - 15);
    return openvdb::Vec3d(std::sqrt(p.x() * p.x() + p.y() * p.y()) - 15, p.z(), 0).length();
  };
  for (const double half_width : {1.5, 3.0, 8.0}) {
    const Read result = read(sample(half_sphere, {1, half_width, 24}));
    CHECK(result.info.kind == VolumeKind::open_unsigned_distance);
    CHECK(is_one_ball(result));
    CHECK(distance_of(result.soup, half_sphere) < 1);
  }
}

TEST_CASE("unsigned volume: an isovalue that is asked for makes two skins, as in any field", "[volume][stage]") {
  const Read result = read(sample(sphere(15.3)), {"", 1.25, 0});
  CHECK(result.info.kind == VolumeKind::at_value);
  CHECK(result.topology.components == 2);
}

TEST_CASE("unsigned volume: the surface does not depend on the number of threads", "[volume][stage]") {
  const auto grid = sample(box({17.3, 20, 2}, {0.2, 0.3, 0.5}));
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const Read alone = read(grid);
  const tbb::global_control many(tbb::global_control::max_allowed_parallelism, 8);
  const Read together = read(grid);
  CHECK(alone.soup.triangles == together.soup.triangles);
  for (size_t v = 0; v < alone.soup.vertices.size(); ++v)
    REQUIRE((alone.soup.vertices[v].x == together.soup.vertices[v].x &&
             alone.soup.vertices[v].y == together.soup.vertices[v].y &&
             alone.soup.vertices[v].z == together.soup.vertices[v].z));
}

TEST_CASE("unsigned volume: what is no distance is refused with what was found and what to do", "[volume][stage]") {
  const auto of = [](double scale, double power, double shift) {
    return sample([=](const openvdb::Vec3d& p) { return shift + scale * std::pow(sphere(15.3)(p), power); });
  };
  CHECK(contains(refusal(of(0.3, 1, 0), ErrorCode::usage), "rise by that a voxel"));
  CHECK(contains(refusal(of(0.4, 2, 0), ErrorCode::usage), "grid \"udf\" is no level set (class unknown, values "));
  CHECK(contains(refusal(of(1, 1, 1.4), ErrorCode::usage), "no unsigned distance: "));
  const auto no_background = sample(sphere(15.3), {1, 100, 23});
  openvdb::tools::changeBackground(no_background->tree(), 0.f);
  CHECK(contains(refusal(no_background, ErrorCode::usage), "background of 0"));
  const auto stretched = sample(sphere(15.3));
  stretched->transform().preScale(openvdb::Vec3d(1, 1, 2));
  CHECK(contains(refusal(stretched, ErrorCode::usage), "no cubes"));
}

TEST_CASE("unsigned volume: broken values are refused by what they are", "[volume][stage]") {
  constexpr float kInfinite = std::numeric_limits<float>::infinity(), kNan = std::numeric_limits<float>::quiet_NaN();
  const auto filled = [](float value, int size) {
    auto grid = openvdb::FloatGrid::create(3);
    grid->denseFill({{0, 0, 0}, {size - 1, size - 1, size - 1}}, value, true);
    return grid;
  };
  for (const float value : {0.f, -0.f, kInfinite}) {
    CHECK(contains(refusal(filled(value, 16), ErrorCode::usage), "no unsigned distance"));
    CHECK(contains(refusal(filled(value, 1), ErrorCode::usage), "--iso"));
  }
  CHECK(contains(refusal(filled(1.5f, 1), ErrorCode::usage), "no unsigned distance"));
  CHECK(contains(refusal(filled(kNan, 16), ErrorCode::nothing_to_mesh), "all its values are 3"));
  const auto one_broken = sample(sphere(15.3));
  one_broken->tree().setValue({15, 0, 0}, kNan);
  CHECK(contains(refusal(one_broken, ErrorCode::unreadable_input), "voxel (15, 0, 0): its value is not a number"));
  const auto signed_zeros = sample([](const openvdb::Vec3d& p) { return std::abs(p.length() - 15); });
  for (auto value = signed_zeros->beginValueOn(); value; ++value)
    if (*value == 0) value.setValue(-0.f);
  CHECK(is_one_ball(read(signed_zeros)));
  const auto infinite_outside = sample(sphere(15.3));
  infinite_outside->tree().setValue({0, 0, 0}, kInfinite);
  CHECK(is_one_ball(read(infinite_outside)));
}
