// Fields whose distances jump: bands on one side of an open surface, and clipped grids.
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cmath>

#include "isoshell/error.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/io/vdb_file.h"
#include "support/catch.h"
#include "support/made_field.h"
#include "support/mesh_files.h"
#include "support/refusals.h"

using namespace isoshell;

namespace {

/// A level set of half width 3 that a function gives inside of a box, written to a file.
template <class Value>
std::string level_set_file(const TemporaryFolder& folder, int32_t size, Value value, float background = 3) {
  openvdb::initialize();
  auto grid = openvdb::FloatGrid::create(background);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  auto to = grid->getAccessor();
  for (int32_t x = 0; x < size; ++x)
    for (int32_t y = 0; y < size; ++y)
      for (int32_t z = 0; z < size; ++z)
        if (const double v = value(x, y, z); std::abs(v) < 3) to.setValue({x, y, z}, float(v));
  const std::string path = folder / "field.vdb";
  openvdb::io::File(path).write({grid});
  return path;
}

}  // namespace

TEST_CASE("jumps: a band of a sheet is closed by the end of its band, or open with --boundary keep", "[volume][unit]") {
  const TemporaryFolder folder;
  const std::string path =
      level_set_file(folder, 32, [](int32_t x, int32_t y, int32_t z) { return z - 15.3 + .05 * (x - y); });
  VolumeReadOptions options;
  VolumeInfo closed, open;
  const TriangleSoup shut = read_volume(path, options, closed);
  CHECK(is_closed_2_manifold_by_edges(shut));
  CHECK(closed.jumping_part > .3);
  CHECK(closed.open_cells == 0);
  options.keep_open = true;
  const TriangleSoup sheet = read_volume(path, options, open);
  CHECK(open.open_cells > 500);
  for (const WorldPoint& p : sheet.vertices) REQUIRE(p.z == Approx(15.3 - .05 * (p.x - p.y)).margin(1e-3));
  CHECK(sheet.vertices.size() > 900);
  options.iso = 0;  // of values that need be no distances
  CHECK(is_closed_2_manifold_by_edges(read_volume(path, options, open)));
}

TEST_CASE("jumps: where the band of a sheet ends whose background is 0 nothing is known, and the sheet is open",
          "[volume][unit]") {
  const TemporaryFolder folder;
  const std::string path = level_set_file(
      folder, 32, [](int32_t x, int32_t y, int32_t z) { return z - 15.3 + .05 * (x - y); }, 0);
  VolumeInfo info;
  const TriangleSoup sheet = read_volume(path, {}, info);
  CHECK(info.open_cells > 50);
  CHECK(info.unknown_values > 0);
  CHECK(sheet.vertices.size() > 900);
  for (const WorldPoint& p : sheet.vertices) {
    if (std::max(std::abs(p.x - 15.5), std::abs(p.y - 15.5)) > 15.5) continue;  // beside the band as in its last voxel
    REQUIRE(p.z == Approx(15.3 - .05 * (p.x - p.y)).margin(1e-3));
  }
}

TEST_CASE("jumps: distances of a closed body have none, and it stays closed with --boundary keep", "[volume][unit]") {
  const TemporaryFolder folder;
  const std::string path = level_set_file(folder, 40, [](int32_t x, int32_t y, int32_t z) {
    const double ball = std::sqrt((x - 20.) * (x - 20.) + (y - 20.) * (y - 20.) + (z - 20.) * (z - 20.)) - 12.3;
    return ball <= -3 ? -2.99 : ball;
  });
  VolumeReadOptions options;
  options.keep_open = true;
  VolumeInfo info;
  CHECK(is_closed_2_manifold_by_edges(read_volume(path, options, info)));
  CHECK(info.jumping_part == 0);
}

TEST_CASE("jumps: values that are no distances, and distances of voxels that are no cubes, have none",
          "[volume][unit]") {
  const auto surface = [](const std::vector<float>& values, const WorldPoint& spacing, VolumeInfo& info) {
    constexpr int64_t n = 24;
    const DenseVolume volume{values.data(),
                             {n, n, n},
                             {n * n, n, 1},
                             {WorldPoint{spacing.x, 0, 0}, {0, spacing.y, 0}, {0, 0, spacing.z}},
                             {0, 0, 0}};
    return surface_of_volume(volume, "mine", {"", {}, 0, VolumeCreases::none, VolumeSides::open, false, true}, info);
  };
  const auto values_of = [](const auto& value) {
    std::vector<float> values;
    for (int x = 0; x < 24; ++x)
      for (int y = 0; y < 24; ++y)
        for (int z = 0; z < 24; ++z) values.push_back(float(value(x, y, z)));
    return values;
  };
  const auto is_whole = [&](const std::vector<float>& values, const WorldPoint& spacing) {
    VolumeInfo info;
    return is_closed_2_manifold_by_edges(surface(values, spacing, info)) && info.jumping_part == 0;
  };
  CHECK(is_whole(values_of([](int x, int y, int z) { return std::hypot(x - 12, y - 12, z - 12) < 7.3 ? -1 : 1; }),
                 {1, 1, 1}));
  CHECK(is_whole(values_of([](int x, int y, int z) {  // a cylinder, whose ends are along the long sides of voxels
                   return std::max(std::hypot(x - 12, y - 12) - 7.3, 3 * (std::abs(z - 12) - 6.4));
                 }),
                 {1, 1, 3}));
  const std::vector<float> cliff = values_of([](int x, int, int z) { return z - 12 - 9 * std::tanh(double(x) - 12); });
  VolumeInfo info;
  surface(cliff, {1, 1, 1}, info);
  CHECK(info.open_cells == 0);
}
