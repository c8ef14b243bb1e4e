// Level sets as files: what OpenVDB, and a later run, read of them.
#include <openvdb/openvdb.h>
#include <openvdb/tools/MeshToVolume.h>

#include <cmath>

#include "isoshell/io/vdb_file.h"
#include "isoshell/io/volume_file.h"
#include "isoshell/openvdb.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/temporary_file.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

LevelSet level_set_of(const TriangleSoup& soup, double band_vox) {
  RemeshOptions options;
  options.vertices = 500;
  options.resolution = 64;
  options.features = {Features::Creases::off, 0};
  options.level_set_band_vox = 3;
  CpuContext context;
  return level_set(prepare(soup, options, context), band_vox, context);
}

openvdb::FloatGrid::Ptr read_grid(const std::string& path, const std::string& name) {
  openvdb::initialize();
  openvdb::io::File file(path);
  file.open();
  return openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name));
}

}  // namespace

TEST_CASE("level set file: OpenVDB reads a level set in world units with a sign everywhere", "[level_set][volume]") {
  const TemporaryFile file("ball.vdb");
  const LevelSet set = level_set_of(shapes::sphere({1, 2, 3}, 5, 48), 4);
  save_level_set(file.path, set);
  const openvdb::FloatGrid::Ptr grid = read_grid(file.path, "surface");
  REQUIRE(grid);
  CHECK(grid->getGridClass() == openvdb::GRID_LEVEL_SET);
  CHECK(grid->activeVoxelCount() == openvdb::Index64(set.voxels.voxel_count()));
  CHECK(grid->background() == Approx(4 * set.frame.voxel_size));
  const auto values = grid->getConstAccessor();
  const auto at = [&](double x) {
    return values.getValue(openvdb::Coord::round(grid->worldToIndex(openvdb::Vec3d(x, 2, 3))));
  };
  CHECK(at(1) == -grid->background());
  CHECK(at(5.9) == Approx(-.1).margin(set.frame.voxel_size));
  CHECK(at(6.5) == Approx(.5).margin(set.frame.voxel_size));
  CHECK(at(20) == grid->background());
  CHECK(grid->tree().activeTileCount() == 0);

  LevelSetWriteOptions options;
  options.name = "halves";
  options.as_half = true;
  options.overwrite = true;
  save_level_set(file.path, set, options);
  CHECK(read_grid(file.path, "halves")->saveFloatAsHalf());
}

TEST_CASE("level set file: voxels of any size have a place in it", "[level_set][volume]") {
  const TemporaryFile file("small.vdb");
  LevelSet set = level_set_of(shapes::sphere({1, 2, 3}, 5, 24), 3);
  for (const double voxel_size : {1e-5, 1e-9}) {
    set.frame.voxel_size = voxel_size;
    set.frame.origin = {-32 * voxel_size, 0, 32 * voxel_size};
    save_level_set(file.path, set, {"surface", false, true});
    VolumeInfo info;
    const TriangleSoup soup = read_volume(file.path, {}, info);
    CHECK(info.voxel_size_world == Approx(voxel_size));
    CHECK(soup.triangles.size() > 1000);
    CHECK(to_openvdb(set)->voxelSize()[0] == Approx(voxel_size));
  }
}

TEST_CASE("level set file: a band that halves do not hold is refused", "[level_set][volume]") {
  const TemporaryFile file("halves.vdb");
  LevelSet set = level_set_of(shapes::sphere({1, 2, 3}, 5, 24), 3);
  const auto save_with = [&](double voxel_size, bool as_half) {
    set.frame.voxel_size = voxel_size;
    save_level_set(file.path, set, {"surface", as_half, true});
  };
  for (const double wrong : {22000., 2e-5}) {
    CHECK(contains(message_of(ErrorCode::usage, [&] { save_with(wrong, true); }), "leave out --level-set-half"));
    save_with(wrong, false);
  }
  for (const double right : {21800., 2.1e-5}) {
    save_with(right, true);
    const openvdb::FloatGrid::Ptr grid = read_grid(file.path, "surface");
    for (auto value = grid->cbeginValueOn(); value; ++value) REQUIRE(std::abs(*value) <= grid->background());
    CHECK(double(grid->background()) == Approx(3 * right).epsilon(1. / 2048));
  }
}

TEST_CASE("level set file: a run reads its surface again", "[level_set][volume]") {
  const TemporaryFile file("ball.vdb");
  const LevelSet set = level_set_of(shapes::sphere({1, 2, 3}, 5, 48), 3);
  save_level_set(file.path, set);
  VolumeInfo info;
  const TriangleSoup soup = read_volume(file.path, {}, info);
  CHECK(info.grid == "surface");
  CHECK(info.grid_class == "level set");
  CHECK(info.open_cells == 0);
  for (const WorldPoint& p : soup.vertices)
    REQUIRE(std::sqrt((p.x - 1) * (p.x - 1) + (p.y - 2) * (p.y - 2) + (p.z - 3) * (p.z - 3)) ==
            Approx(5).margin(.2 * set.frame.voxel_size));
}

TEST_CASE("level set file: no value of OpenVDB's mesh to volume is nearer, and nearly all are the same",
          "[level_set][volume]") {
  const TemporaryFile file("ball.vdb");
  const TriangleSoup ball = shapes::sphere({1, 2, 3}, 5, 24);
  save_level_set(file.path, level_set_of(ball, 3));
  const openvdb::FloatGrid::Ptr ours = read_grid(file.path, "surface");
  std::vector<openvdb::Vec3s> points;
  for (const WorldPoint& p : ball.vertices)
    points.emplace_back(openvdb::Vec3s(ours->worldToIndex(openvdb::Vec3d(p.x, p.y, p.z))));
  std::vector<openvdb::Vec3I> triangles;
  for (const auto& t : ball.triangles) triangles.emplace_back(t[0], t[1], t[2]);
  const openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I> mesh(points, triangles);
  const auto theirs = openvdb::tools::meshToVolume<openvdb::FloatGrid>(mesh, ours->transform(), 3, 3,
                                                                       openvdb::tools::DISABLE_RENORMALIZATION);
  const auto values = ours->getConstAccessor();
  const double voxel = ours->voxelSize()[0];
  int64_t same = 0, all = 0;
  for (auto it = theirs->cbeginValueOn(); it; ++it) {
    const double there = std::abs(*it) / voxel, here = std::abs(values.getValue(it.getCoord())) / voxel;
    REQUIRE(here <= there + 1e-4);
    same += here >= there - 1e-4 ? 1 : 0;
    ++all;
  }
  CHECK(double(same) > .95 * double(all));
}
