// Grids of .vdb files as values of any place, against OpenVDB's own samplers.
#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <limits>
#include <random>

#include "isoshell/error.h"
#include "isoshell/io/grid_field.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/temporary_file.h"

using namespace isoshell;
using openvdb::math::Transform;

namespace {

constexpr int kSide = 12;  // voxels of a block

/// Of voxels that are cubes, of any other boxes, turned, and skewed; none stands where another does.
std::vector<Transform::Ptr> transforms() {
  std::vector<Transform::Ptr> all = {Transform::createLinearTransform(0.25)};
  all.push_back(Transform::createLinearTransform(1));
  all.back()->preScale({0.3, 0.5, 0.2});
  all.back()->postTranslate({-1, 2, 0.7});
  all.push_back(Transform::createLinearTransform(0.4));
  all.back()->postRotate(0.7, openvdb::math::X_AXIS);
  all.back()->postRotate(-0.4, openvdb::math::Z_AXIS);
  all.back()->postTranslate({10, -3, 2});
  all.push_back(Transform::createLinearTransform(0.4));
  all.back()->postShear(0.3, openvdb::math::X_AXIS, openvdb::math::Y_AXIS);
  return all;
}

template <class T>
T made_of(std::mt19937& random) {
  if constexpr (openvdb::VecTraits<T>::IsVec) {
    using Number = typename T::ValueType;
    const auto x = made_of<Number>(random), y = made_of<Number>(random);
    return T(x, y, made_of<Number>(random));
  } else {
    return T(double(int64_t(random()) - (int64_t(1) << 31)) / (std::is_integral_v<T> ? 1 : double(1u << 29)));
  }
}

/// Of random values, half of them inactive.
template <class Grid>
typename Grid::Ptr block(const std::string& name, const Transform::Ptr& transform, uint32_t seed = 1) {
  openvdb::initialize();
  using Value = typename Grid::ValueType;
  std::mt19937 random(seed);
  auto grid = Grid::create(made_of<Value>(random));
  grid->setName(name);
  grid->setTransform(transform);
  auto voxels = grid->getAccessor();
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j)
      for (int k = 0; k < kSide; ++k) {
        const auto value = made_of<Value>(random);
        if (random() % 2 == 0)
          voxels.setValueOn({i, j, k}, value);
        else
          voxels.setValueOff({i, j, k}, value);
      }
  return grid;
}

std::vector<WorldPoint> places_in(const Transform& transform) {
  std::mt19937 random(7);
  std::vector<WorldPoint> places;
  const auto in_block = [&] { return -2 + (kSide + 4) * (double(random()) / 4294967296.0); };
  for (int n = 0; n < 500; ++n) {
    const double i = in_block(), j = in_block(), k = in_block();
    const openvdb::Vec3d world = transform.indexToWorld(openvdb::Vec3d(i, j, k));
    places.push_back({world.x(), world.y(), world.z()});
  }
  return places;
}

TemporaryFile written(const openvdb::GridPtrVec& grids) {
  TemporaryFile file("fields.vdb");
  openvdb::io::File(file.path).write(grids);
  return file;
}

template <class T>
std::vector<double> numbers_of(const T& value) {
  if constexpr (openvdb::VecTraits<T>::IsVec)
    return {double(value.x()), double(value.y()), double(value.z())};
  else
    return {double(value)};
}

/// The largest difference from what OpenVDB's sampler finds at random places, over the size of the values.
template <class Sampler, class Grid>
double difference(const Grid& grid) {
  const auto read = std::static_pointer_cast<Grid>(grid.deepCopyGrid());
  const TemporaryFile file = written({read});
  openvdb::io::File again(file.path);
  again.open();
  const auto held = openvdb::gridPtrCast<Grid>(again.readGrid(grid.getName()));  // halves are rounded
  const std::vector<WorldPoint> places = places_in(grid.transform());
  const GridValues found = read_grid_fields(file.path, {grid.getName()})[0]->at(places);
  const auto count = size_t(found.values.components);
  REQUIRE(found.values.values.size() == places.size() * count);
  double worst = 0;
  for (size_t p = 0; p < places.size(); ++p) {
    const openvdb::Vec3d at = held->worldToIndex({places[p].x, places[p].y, places[p].z});
    const std::vector<double> expected = numbers_of(Sampler::sample(held->tree(), at));
    for (size_t i = 0; i < count; ++i)
      worst = std::max(worst, std::abs(found.values.values[count * p + i] - expected[i]));
  }
  return worst;
}

std::string refusal(const std::string& path, const std::string& grid) {
  return message_of(ErrorCode::usage, [&] { read_grid_fields(path, {grid}); });
}

}  // namespace

TEST_CASE("grids: real numbers are those of OpenVDB's box sampler, whatever the transform", "[grids][vdb]") {
  using openvdb::tools::BoxSampler;
  for (const Transform::Ptr& transform : transforms())
    for (const bool as_half : {false, true}) {
      const auto floats = block<openvdb::FloatGrid>("t", transform);
      const auto vectors = block<openvdb::Vec3SGrid>("v", transform);
      floats->setSaveFloatAsHalf(as_half);
      vectors->setSaveFloatAsHalf(as_half);
      CHECK(difference<BoxSampler>(*floats) < 1e-5);
      CHECK(difference<BoxSampler>(*vectors) < 1e-5);
      CHECK(difference<BoxSampler>(*block<openvdb::DoubleGrid>("d", transform)) < 1e-12);
      CHECK(difference<BoxSampler>(*block<openvdb::Vec3DGrid>("w", transform)) < 1e-12);
    }
}

TEST_CASE("grids: whole numbers are those of the nearest voxel", "[grids][vdb]") {
  using openvdb::tools::PointSampler;
  for (const Transform::Ptr& transform : transforms()) {
    CHECK(difference<PointSampler>(*block<openvdb::Int32Grid>("id", transform)) == 0);
    CHECK(difference<PointSampler>(*block<openvdb::Int64Grid>("id", transform)) == 0);
    CHECK(difference<PointSampler>(*block<openvdb::Vec3IGrid>("cell", transform)) == 0);
  }
}

TEST_CASE("grids: staggered vectors are those of OpenVDB's staggered sampler", "[grids][vdb]") {
  for (const Transform::Ptr& transform : transforms()) {
    const auto grid = block<openvdb::Vec3SGrid>("v", transform);
    grid->setGridClass(openvdb::GRID_STAGGERED);
    CHECK(difference<openvdb::tools::StaggeredBoxSampler>(*grid) < 1e-5);
    CHECK(difference<openvdb::tools::BoxSampler>(*grid) > 0.1);
  }
}

TEST_CASE("grids: beside all active voxels a value is the background, and is counted", "[grids][vdb]") {
  const auto grid = openvdb::DoubleGrid::create(0.1);
  grid->setName("t");
  grid->getAccessor().setValueOn({0, 0, 0}, 0.7);
  const TemporaryFile file = written({grid});
  constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
  const GridValues found = read_grid_fields(file.path, {"t"})[0]->at(
      {{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}, {5.3, 2.7, 1.1}, {1e300, 0, 0}, {kNothing, 0, 0}});
  CHECK(found.values.values == std::vector<double>{0.7, 0.7 + 0.5 * (0.1 - 0.7), 0.1, 0.1, 0.1, 0.1});
  CHECK(found.outside == 4);
}

TEST_CASE("grids: what cannot be sampled is refused with what there is", "[grids][vdb]") {
  auto mask = openvdb::BoolGrid::create(false);
  mask->setName("mask");
  const TemporaryFile file = written(
      {block<openvdb::FloatGrid>("t", transforms()[0]), block<openvdb::FloatGrid>("t", transforms()[1], 2), mask});
  CHECK(contains(refusal(file.path, "v"), "has no grid \"v\""));
  CHECK(contains(refusal(file.path, "v"), "\"t[0]\" (Tree_float_5_4_3), \"t[1]\""));
  CHECK(contains(refusal(file.path, "mask"), "has type Tree_bool_5_4_3"));
  CHECK(read_grid_fields(file.path, {"t[1]", "t[0]", "t[1]"}).size() == 2);
  CHECK(read_grid_fields(file.path, {"t[1]"})[0]->digest() != read_grid_fields(file.path, {"t[0]"})[0]->digest());
  CHECK(contains(message_of(ErrorCode::out_of_memory, [&] { read_grid_fields(file.path, {"t[1]"}, 20000); }),
                 "more than the limit"));
}
