// Grids in memory: what a run makes of them is what it makes of a file of the same grid.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#if __has_include(<nanovdb/util/OpenToNanoVDB.h>)
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#define ISOSHELL_TEST_NANO
#endif

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <sstream>
#include <vector>

#include "isoshell/advanced/each_voxel.h"
#include "isoshell/nanovdb.h"
#include "isoshell/openvdb.h"
#include "isoshell/run/run.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"
#include "voxel/leaf.h"

using namespace isoshell;

namespace {

openvdb::FloatGrid::Ptr ball() {
  openvdb::initialize();
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(9.2f, openvdb::Vec3f(3, -4, 5), 0.5f, 3.f);
  grid->setName("ball");
  return grid;
}

openvdb::FloatGrid::Ptr turned_ball() {
  auto grid = ball();
  openvdb::math::Mat4d turn = openvdb::math::Mat4d::identity();
  turn.postRotate(openvdb::math::Y_AXIS, 0.7);
  turn.postScale(openvdb::Vec3d(-1, 2, 1));
  grid->transform().postMult(turn);
  return grid;
}

openvdb::DoubleGrid::Ptr fog() {
  auto grid = openvdb::DoubleGrid::create(0);
  for (int i = -6; i <= 6; ++i)
    for (int j = -6; j <= 6; ++j)
      for (int k = -6; k <= 6; ++k)
        grid->tree().setValueOn(openvdb::Coord(i, j, k), std::max(0., 1 - std::sqrt(i * i + j * j + k * k) / 6));
  grid->setGridClass(openvdb::GRID_FOG_VOLUME);
  return grid;
}

openvdb::Int32Grid::Ptr labels() {
  auto grid = openvdb::Int32Grid::create(0);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(-9, 0, 0), openvdb::Coord(-1, 8, 8)), 1);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(0, 0, 0), openvdb::Coord(8, 8, 8)), 2);
  grid->insertMeta("label:2", openvdb::StringMetadata("femur"));
  return grid;
}

RunRequest request_to(const std::string& output) {
  RunRequest request;
  request.output.path = output;
  request.options.values.vertices = 600;
  return request;
}

bool are_same(const TriangleSoup& a, const TriangleSoup& b) {
  return a.triangles == b.triangles && a.regions.labels == b.regions.labels &&
         std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(), same_bits);
}

/// Whether a run from the grid has the surface and the bytes of a run from the file.
bool run_the_same(const MemoryGrid& grid, const std::string& path, const InputRequest& input = {}) {
  const TemporaryFolder folder;
  RunRequest of_file = request_to(folder / "of_file.ply"), of_grid = request_to(folder / "of_grid.ply");
  of_file.input = named_input(path, input);
  of_grid.input = input;
  CpuContext context;
  Input made = input_of(grid, "grid", input_request_of(of_grid), context);
  const bool are_read_the_same = are_same(made.soup, read_input_of(of_file, context, {}).soup);
  run(of_file, context);
  run(std::move(made), of_grid, context);
  return are_read_the_same && get_file(of_file.output.path) == get_file(of_grid.output.path);
}

void write(const std::string& path, const openvdb::GridBase::Ptr& grid) {
  openvdb::io::File file(path);
  file.write({grid});
}

InputRequest with_iso(double iso) {
  InputRequest request;
  request.iso = iso;
  return request;
}

LevelSet level_set_of_torus() {
  RemeshOptions options;
  options.resolution = 60;
  options.features = {Features::Creases::off, 0};
  options.level_set_band_vox = 3;
  CpuContext context;
  return level_set(prepare(shapes::torus(3, 1, 40, 24), options, context), 3, context);
}

/// A level set as arrays, with its voxels in a random order.
struct Arrays {
  std::vector<Voxel> voxels;
  std::vector<float> values;

  explicit Arrays(const LevelSet& set) {
    for_each_voxel(set.voxels, [&](Voxel v, int64_t) { voxels.push_back(v); });
    std::shuffle(voxels.begin(), voxels.end(), std::mt19937(7));
    for (const Voxel v : voxels)
      values.push_back(float(double(set.distance_vox[find_voxel(set.voxels.view(), v)]) * set.frame.voxel_size));
  }
  View<const Voxel> view_of_voxels() const { return {voxels.data(), int64_t(voxels.size())}; }
  View<const float> view_of_values() const { return {values.data(), int64_t(values.size())}; }
};

SparseVolume sparse(const Arrays& arrays, const LevelSet& set) {
  const double h = set.frame.voxel_size;
  SparseVolume volume{arrays.view_of_voxels(), arrays.view_of_values(), float(set.band_vox * h), true};
  volume.step_world = {WorldPoint{h, 0, 0}, WorldPoint{0, h, 0}, WorldPoint{0, 0, h}};
  const WorldPoint& o = set.frame.origin;
  volume.origin_world = {o.x + h / 2, o.y + h / 2, o.z + h / 2};
  return volume;
}

bool are_same(const openvdb::FloatGrid& a, const openvdb::FloatGrid& b) {
  if (a.activeVoxelCount() != b.activeVoxelCount() || a.background() != b.background()) return false;
  if (a.transform() != b.transform() || a.getGridClass() != b.getGridClass()) return false;
  const auto there = b.getConstAccessor();
  for (auto it = a.cbeginValueAll(); it; ++it) {
    float value;
    if (there.probeValue(it.getCoord(), value) != it.isValueOn() || value != *it) return false;
  }
  return true;
}

}  // namespace

TEST_CASE("memory grid: a run from a grid of OpenVDB gives the bytes of a run from its file", "[memory_grid]") {
  const TemporaryFolder folder;
  const std::string path = folder / "grid.vdb";
  write(path, ball());
  CHECK(run_the_same(read_grid(*ball()), path));
  write(path, turned_ball());
  CHECK(run_the_same(read_grid(*turned_ball()), path));
  write(path, fog());
  CHECK(run_the_same(read_grid(*fog()), path, with_iso(.4)));
  write(path, labels());
  CHECK(run_the_same(read_grid(*labels()), path));
}

TEST_CASE("memory grid: a grid lives as long as what was read of it", "[memory_grid]") {
  openvdb::GridBase::Ptr grid = ball();
  const MemoryGrid read = read_grid(*grid);
  grid.reset();
  const Context context;
  CHECK(input_of(read, "grid", {}, context).soup.triangles.size() > 1000);
}

TEST_CASE("memory grid: grids without a surface are refused as in files", "[memory_grid]") {
  const Context context;
  const auto message = [&](ErrorCode code, const openvdb::GridBase& grid, const InputRequest& request = {}) {
    return message_of(code, [&] { input_of(read_grid(grid), "mine", request, context); });
  };
  openvdb::BoolGrid::Ptr mask = openvdb::BoolGrid::create();
  mask->setName("flags");
  CHECK(
      contains(message(ErrorCode::nothing_to_mesh, *mask), "mine: grid \"flags\" (bool, unknown) holds no distances"));
  CHECK(contains(message(ErrorCode::usage, *fog()), "say by --iso"));
  CHECK(contains(message(ErrorCode::usage, *labels(), with_iso(1)), "--iso is for volumes"));
  InputRequest islands;
  islands.labels.smallest_island_vox = 3;
  CHECK(contains(message(ErrorCode::usage, *ball(), islands), "--smallest-island is for volumes of labels"));
  const auto frustum = openvdb::FloatGrid::create(1);
  frustum->setTransform(
      openvdb::math::Transform::createFrustumTransform(openvdb::BBoxd(openvdb::Vec3d(0), openvdb::Vec3d(9)), .5, 10));
  CHECK(contains(message(ErrorCode::unreadable_input, *frustum), "only linear ones are read"));
}

TEST_CASE("memory grid: the bytes of a stream are what its file is", "[memory_grid]") {
  const TemporaryFolder folder;
  write(folder / "grid.vdb", ball());
  std::ostringstream stream;
  openvdb::io::Stream(stream).write({ball()});
  const std::string bytes = stream.str();
  const Context context;
  const Input made = input_of_vdb({bytes.data(), int64_t(bytes.size())}, "mine", {}, context);
  const Input read = read_input(named_input(folder / "grid.vdb"), context);
  CHECK(made.facts.path == "mine");
  CHECK(are_same(made.soup, read.soup));
}

TEST_CASE("memory grid: voxels and values in any order are the level set that they were taken from",
          "[memory_grid][level_set]") {
  const TemporaryFolder folder;
  const LevelSet set = level_set_of_torus();
  save_level_set(folder / "set.vdb", set);
  const Arrays arrays(set);
  CHECK(run_the_same(sparse_grid(sparse(arrays, set), "mine"), folder / "set.vdb"));
}

TEST_CASE("memory grid: voxels may have negative coordinates, and values that are not known", "[memory_grid]") {
  Arrays arrays(level_set_of_torus());
  std::vector<Voxel> moved = arrays.voxels;
  for (Voxel& v : moved) v = {v.x - 70, v.y - 1000, v.z - 33};
  const Context context;
  const auto triangles = [&](const std::vector<Voxel>& voxels) {
    const SparseVolume volume{{voxels.data(), int64_t(voxels.size())}, arrays.view_of_values(), 1, true};
    return input_of(sparse_grid(volume, "mine"), "mine", {}, context).soup.triangles.size();
  };
  const size_t all = triangles(arrays.voxels);
  CHECK(all > 1000);
  CHECK(triangles(moved) == all);
  const auto nearest = std::min_element(arrays.values.begin(), arrays.values.end(),
                                        [](float a, float b) { return std::abs(a) < std::abs(b); });
  *nearest = std::numeric_limits<float>::quiet_NaN();
  CHECK(triangles(moved) < all);
}

TEST_CASE("memory grid: voxels that are no grid are refused by the first that is wrong", "[memory_grid]") {
  const std::vector<Voxel> voxels{{0, 0, 0}, {5, -3, 9}, {1, 0, 0}, {5, -3, 9}};
  const std::vector<float> values{1, -1, 1, -1};
  const auto message = [&](ErrorCode code, const SparseVolume& volume, int64_t limit = 0) {
    return message_of(code, [&] { sparse_grid(volume, "mine", limit); });
  };
  SparseVolume volume{{voxels.data(), 4}, {values.data(), 4}, 1};
  CHECK(contains(message(ErrorCode::usage, volume), "mine: voxel (5, -3, 9) is given twice, as number 1 and 3"));
  volume.values.size = 3;
  CHECK(contains(message(ErrorCode::usage, volume), "has 3 values and 4 voxels"));
  volume.voxels.size = volume.values.size = 3;
  CHECK(message(ErrorCode::usage, volume).empty());
  CHECK(contains(message(ErrorCode::out_of_memory, volume, 1000), "more than the limit"));
  volume.step_world[2] = {1, 1, 0};
  volume.step_world[1] = {1, 1, 0};
  CHECK(contains(message(ErrorCode::usage, volume), "span no volume"));
  const std::vector<float> infinite{1, INFINITY, 1};
  CHECK(contains(message(ErrorCode::usage, {{voxels.data(), 3}, {infinite.data(), 3}, 1}),
                 "value 1, of voxel (5, -3, 9), is infinite"));
  const std::vector<Voxel> far{{0, 0, 0}, {0, -2000000000, 0}};
  CHECK(contains(message(ErrorCode::usage, {{far.data(), 2}, {values.data(), 2}, 1}), "farther out than 1073741824"));
  CHECK(contains(message(ErrorCode::usage, {{}, {}, 1}), "has no voxels"));
}

TEST_CASE("memory grid: a level set is the grid that its file holds", "[memory_grid][level_set]") {
  const TemporaryFolder folder;
  const LevelSet set = level_set_of_torus();
  LevelSetWriteOptions options;
  options.name = "torus";
  save_level_set(folder / "set.vdb", set, options);
  openvdb::io::File file(folder / "set.vdb");
  file.open();
  const auto saved = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("torus"));
  const openvdb::FloatGrid::Ptr made = to_openvdb(set, options);
  CHECK(made->getName() == "torus");
  CHECK(are_same(*saved, *made));
}

TEST_CASE("memory grid: a shell has its distances and sites in every voxel", "[memory_grid]") {
  RemeshOptions options;
  options.resolution = 40;
  options.want_shell = true;
  CpuContext context;
  const Prepared prepared = prepare(shapes::sphere({0, 0, 0}, 2, 24), options, context);
  const Shell& shell = prepared.shell();
  const double voxel = prepared.surface().frame.voxel_size;
  const openvdb::GridPtrVec grids = to_openvdb(shell, prepared.surface().frame);
  REQUIRE(grids.size() == 3);
  const auto distance = openvdb::gridPtrCast<openvdb::FloatGrid>(grids[0]);
  const auto site = openvdb::gridPtrCast<openvdb::Int32Grid>(grids[1]);
  const auto squared = openvdb::gridPtrCast<openvdb::Int32Grid>(grids[2]);
  CHECK(distance->activeVoxelCount() == openvdb::Index64(shell.voxels.voxel_count()));
  for_each_voxel(shell.voxels, [&](Voxel v, int64_t i) {
    const openvdb::Coord at(v.x, v.y, v.z);
    REQUIRE(site->tree().getValue(at) == int32_t(shell.closest_site[i]));
    REQUIRE(squared->tree().getValue(at) == int32_t(shell.distance_sq_vox[i]));
    REQUIRE(distance->tree().getValue(at) == Approx(std::sqrt(double(shell.distance_sq_vox[i])) * voxel));
  });
}

TEST_CASE("memory grid: every voxel of a set is visited once, in the order of the arrays beside it", "[memory_grid]") {
  const LevelSet set = level_set_of_torus();
  int64_t next = 0;
  for_each_voxel(set.voxels, [&](Voxel v, int64_t i) {
    REQUIRE(i == next++);
    REQUIRE(find_voxel(set.voxels.view(), v) == i);
  });
  CHECK(next == set.voxels.voxel_count());
}

#ifdef ISOSHELL_TEST_NANO
TEST_CASE("memory grid: a run from a handle of NanoVDB gives the bytes of a run from its file", "[memory_grid]") {
  const TemporaryFolder folder;
  const auto handle = nanovdb::openToNanoVDB(*ball());
  nanovdb::io::writeGrid(folder / "ball.nvdb", handle);
  CHECK(run_the_same(read_grid(handle), folder / "ball.nvdb"));
  const auto fog_handle = nanovdb::openToNanoVDB(*fog());
  nanovdb::io::writeGrid(folder / "fog.nvdb", fog_handle);
  CHECK(run_the_same(read_grid(fog_handle), folder / "fog.nvdb", with_iso(.4)));
}

TEST_CASE("memory grid: a level set goes out to NanoVDB and comes back", "[memory_grid][level_set]") {
  const TemporaryFolder folder;
  const LevelSet set = level_set_of_torus();
  save_level_set(folder / "set.vdb", set);
  const auto handle = to_nanovdb(set);
  const nanovdb::NanoGrid<float>* const grid = handle.grid<float>();
  REQUIRE(grid);
  CHECK(grid->activeVoxelCount() == uint64_t(set.voxels.voxel_count()));
  CHECK(run_the_same(read_grid(handle), folder / "set.vdb"));
}

TEST_CASE("memory grid: the bytes of a grid of NanoVDB are a source wherever they begin", "[memory_grid]") {
  const auto handle = nanovdb::openToNanoVDB(*ball());
  const auto* const begin = reinterpret_cast<const char*>(handle.data());
  std::vector<char> shifted(1, ' ');
  shifted.insert(shifted.end(), begin, begin + handle.size());
  const Context context;
  const Input input = input_of_vdb({shifted.data() + 1, int64_t(handle.size())}, "mine", {}, context);
  CHECK(input.soup.vertices.size() == input_of(read_grid(handle), "mine", {}, context).soup.vertices.size());
}

TEST_CASE("memory grid: of several grids of NanoVDB in one row of bytes one is named", "[memory_grid]") {
  const auto other = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(5.f, openvdb::Vec3f(12, -4, 5), .5f, 3.f);
  other->setName("other");
  const auto mine = nanovdb::openToNanoVDB(*ball()), others = nanovdb::openToNanoVDB(*other);
  std::vector<char> row;
  for (const auto* handle : {&mine, &others}) {
    const auto* const begin = reinterpret_cast<const char*>(handle->data());
    row.insert(row.end(), begin, begin + handle->size());
  }
  const View<const char> bytes{row.data(), int64_t(row.size())};
  Context context;
  InputRequest request;
  const auto read = [&] { return input_of_vdb(bytes, "row", request, context); };
  CHECK(contains(message_of(ErrorCode::usage, read), "\"other\""));
  request.grid = "other";
  CHECK(read().soup.vertices.size() == input_of(read_grid(others), "mine", {}, context).soup.vertices.size());
  context.memory_limit_bytes = 1000;
  CHECK(contains(message_of(ErrorCode::out_of_memory, read), "more than the limit"));
}

TEST_CASE("memory grid: several level sets of a file of NanoVDB are those of a file of OpenVDB", "[regions][vdb]") {
  const TemporaryFolder folder;
  const auto other = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(5.f, openvdb::Vec3f(12, -4, 5), .5f, 3.f);
  other->setName("ball2");
  const openvdb::FloatGrid::Ptr mine = ball();
  openvdb::io::File(folder / "balls.vdb").write({mine, other, fog()});
  std::vector<nanovdb::GridHandle<nanovdb::HostBuffer>> handles;
  handles.push_back(nanovdb::openToNanoVDB(*other));
  handles.push_back(nanovdb::openToNanoVDB(*mine));
  handles.push_back(nanovdb::openToNanoVDB(*fog()));
  nanovdb::io::writeGrids(folder / "balls.nvdb", handles);
  const Input of_vdb = read_input(named_input(folder / "balls.vdb:ball*"), 0),
              of_nano = read_input(named_input(folder / "balls.nvdb:ball*"), 0);
  REQUIRE(of_nano.soup.regions.names.size() == 2);
  CHECK(of_nano.soup.regions.names[1].name == "ball2");
  CHECK(of_nano.soup.triangles == of_vdb.soup.triangles);
  const std::string words = message_of(ErrorCode::usage, [&] { read_input(named_input(folder / "balls.nvdb:x*"), 0); });
  CHECK(contains(words, "no level set has a name like \"x*\""));
}

TEST_CASE("memory grid: bytes of NanoVDB that are no such grid are refused", "[memory_grid]") {
  const auto handle = nanovdb::openToNanoVDB(*ball());
  const auto* const begin = reinterpret_cast<const std::byte*>(handle.data());
  const Context context;
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { nano_grid({begin, 500}); }), "its 500 bytes"));
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { nano_grid({begin + 8, 5000}); }), "multiple of 32"));
  CHECK(contains(message_of(ErrorCode::unreadable_input, [&] { nano_grid({begin + 32, 5000}); }), "do not begin"));
  CHECK(contains(message_of(ErrorCode::unreadable_input,
                            [&] {
                              input_of(nano_grid({begin, 5000}), "mine", {}, context);
                            }),
                 "outside of the grid"));
  CHECK(contains(message_of(ErrorCode::usage, [&] { read_grid(nanovdb::GridHandle<>()); }), "deviceDownload"));
}
#endif
