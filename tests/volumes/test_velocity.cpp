// Velocities from .vdb files, against the linear field that they were written from.
#include <openvdb/openvdb.h>
#include <unistd.h>

#include <cmath>
#include <limits>

#include "isoshell/error.h"
#include "isoshell/io/velocity_vdb.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/temporary_file.h"

using namespace isoshell;

namespace {

WorldPoint spin(WorldPoint p) { return {-0.1 * p.y, 0.1 * p.x, 0.05 * p.z}; }

/// A block of voxels of edge 1/2, whose centres are at their indices' places.
openvdb::Vec3SGrid::Ptr spinning_block() {
  openvdb::initialize();
  auto grid = openvdb::Vec3SGrid::create();
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  grid->setName("v");
  auto voxels = grid->getAccessor();
  for (int i = -8; i <= 8; ++i)
    for (int j = -8; j <= 8; ++j)
      for (int k = -8; k <= 8; ++k) {
        const WorldPoint v = spin({i * 0.5, j * 0.5, k * 0.5});
        voxels.setValueOn({i, j, k}, openvdb::Vec3f(float(v.x), float(v.y), float(v.z)));
      }
  return grid;
}

TemporaryFile written(const openvdb::GridPtrVec& grids) {
  TemporaryFile file(".vdb");
  openvdb::io::File(file.path).write(grids);
  return file;
}

std::string refusal(const std::string& path, const std::string& grid) {
  return message_of(ErrorCode::unreadable_input, [&] { read_velocity(path, grid); });
}

}  // namespace

TEST_CASE("velocity: between voxels it is interpolated, and beside the block there is none", "[velocity][vdb]") {
  const TemporaryFile file = written({spinning_block()});
  const auto field = read_velocity(file.path, "v");
  const std::vector<WorldPoint> points = {{0, 0, 0}, {0.3, -1.7, 2.21}, {3.99, 3.99, -3.99}, {9, 0, 0}};
  const std::vector<WorldPoint> found = field->velocities_at(points);
  for (size_t i = 0; i < 3; ++i) {
    const WorldPoint expected = spin(points[i]);
    CHECK(std::abs(found[i].x - expected.x) + std::abs(found[i].y - expected.y) + std::abs(found[i].z - expected.z) <
          1e-6);
  }
  CHECK(std::isnan(found[3].x));
}

TEST_CASE("velocity: points go by the velocity of the middle of their way, or stay where there is none",
          "[velocity][vdb]") {
  const TemporaryFile file = written({spinning_block()});
  const auto field = read_velocity(file.path, "v");
  const WorldPoint p{1, 2, 3}, v = spin(p), there = spin({p.x + v.x / 2, p.y + v.y / 2, p.z + v.z / 2});
  const std::vector<WorldPoint> carried = carry_with_velocity({p, {9, 0, 0}}, *field);
  CHECK(std::abs(carried[0].x - p.x - there.x) + std::abs(carried[0].y - p.y - there.y) < 1e-6);
  CHECK((carried[1].x == 9 && carried[1].y == 0 && carried[1].z == 0));
}

TEST_CASE("velocity: from memory it is what it is from a file that holds the same", "[velocity][vdb]") {
  constexpr int kSide = 17;
  std::vector<float> values;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k) {
        const WorldPoint v = spin({i * 0.5 - 4, j * 0.5 - 4, k * 0.5 - 4});
        for (const double part : {v.x, v.y, v.z}) values.push_back(float(part));
      }
  auto grid = spinning_block();
  grid->getAccessor().setValueOff({-8, -8, -7});
  values[3 + 1] = std::numeric_limits<float>::quiet_NaN();
  std::array<DenseVolume, 3> parts;
  for (size_t axis = 0; axis < 3; ++axis)
    parts[axis] = {values.data() + axis,
                   {kSide, kSide, kSide},
                   {3 * kSide * kSide, 3 * kSide, 3},
                   {WorldPoint{.5, 0, 0}, {0, .5, 0}, {0, 0, .5}},
                   {-4, -4, -4}};
  const TemporaryFile file = written({grid});
  std::vector<WorldPoint> points = {{-4, -4, -3.5}, {-4.6, 0, 0}};
  for (int i = 0; i < 300; ++i) points.push_back({-4.2 + 0.027 * i, 4.1 - 0.023 * i, -3.9 + 0.021 * i});
  const auto there = read_velocity(file.path, "v")->velocities_at(points);
  const auto here = velocity_of(parts, "velocities")->velocities_at(points);
  for (size_t i = 0; i < points.size(); ++i) {
    REQUIRE(std::isnan(here[i].x) == std::isnan(there[i].x));
    if (std::isnan(here[i].x)) continue;
    CHECK(std::abs(here[i].x - there[i].x) + std::abs(here[i].y - there[i].y) + std::abs(here[i].z - there[i].z) <
          1e-12);
  }
  CHECK(std::isnan(here[0].x));
  values[0] = std::numeric_limits<float>::infinity();
  CHECK_THROWS_AS(velocity_of(parts, "velocities"), Error);
  parts[0].step_world[1] = {0, 0, 0};
  CHECK_THROWS_AS(velocity_of(parts, "velocities"), Error);
}

TEST_CASE("velocity: what is no field of vectors is refused with what there is", "[velocity][vdb]") {
  auto broken = spinning_block();
  broken->setName("broken");
  broken->getAccessor().setValueOn({1, 2, 3}, openvdb::Vec3f(0, std::numeric_limits<float>::quiet_NaN(), 0));
  auto distance = openvdb::FloatGrid::create(1);
  distance->setName("surface");
  distance->getAccessor().setValueOn({0, 0, 0}, 0.5f);
  const TemporaryFile file = written({broken, distance});
  CHECK(contains(refusal(file.path, "v"), "no grid \"v\""));
  CHECK(contains(refusal(file.path, "v"), "\"surface\" (Tree_float_5_4_3)"));
  CHECK(contains(refusal(file.path, "surface"), "has type Tree_float_5_4_3; velocities are a Vec3SGrid"));
  CHECK(contains(refusal(file.path, "broken"), "voxel [1, 2, 3]"));
}
