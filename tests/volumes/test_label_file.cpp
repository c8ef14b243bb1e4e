// Volumes of labels as files: read as they were written, by whatever program, and refused with what is wrong.
#include <openvdb/openvdb.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>

#include "isoshell/error.h"
#include "isoshell/io/input.h"
#include "isoshell/io/label_file.h"
#include "isoshell/io/volume_file.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/temporary_file.h"

using namespace isoshell;

namespace {

void write(const std::string& path, const openvdb::GridPtrVec& grids) {
  openvdb::io::File file(path);
  file.write(grids);
}

template <class Grid>
typename Grid::Ptr new_grid(const std::string& name, typename Grid::ValueType background) {
  openvdb::initialize();
  auto grid = Grid::create(background);
  grid->setName(name);
  return grid;
}

int32_t label_at(const LabelVolume& volume, int i, int j, int k) {
  return volume.labels[size_t((k * volume.size_vox[1] + j) * volume.size_vox[0] + i)];
}

/// 11 x 9 x 17 voxels with labels that tell where they stand.
LabelVolume numbered() {
  LabelVolume volume;
  volume.size_vox = {11, 9, 17};
  for (int k = 0; k < 17; ++k)
    for (int j = 0; j < 9; ++j)
      for (int i = 0; i < 11; ++i) volume.labels.push_back(i < 2 ? -4 : i + 100 * j - 10000 * k);
  volume.background = -4;
  volume.names = {{-10000, "top"}, {3, "a b: c"}};
  return volume;
}

void check_same(const LabelVolume& a, const LabelVolume& b) {
  CHECK(a.size_vox == b.size_vox);
  CHECK(a.labels == b.labels);
  CHECK(a.background == b.background);
  const auto check_point = [](const WorldPoint& p, const WorldPoint& q) {
    CHECK(std::abs(p.x - q.x) + std::abs(p.y - q.y) + std::abs(p.z - q.z) < 1e-12);
  };
  check_point(a.origin_world, b.origin_world);
  for (size_t i = 0; i < 3; ++i) check_point(a.step_world[i], b.step_world[i]);
  REQUIRE(a.names.size() == b.names.size());
  for (size_t i = 0; i < a.names.size(); ++i) {
    CHECK(a.names[i].label == b.names[i].label);
    CHECK(a.names[i].name == b.names[i].name);
  }
}

Error refusal(const std::string& path, const LabelReadOptions& options = {}) {
  return error_of([&] { read_labels(path, options); });
}

}  // namespace

TEST_CASE("labels: a written volume comes back, with steps along the axes, mirrored or skew", "[labels][unit]") {
  const TemporaryFile file("labels.vdb");
  LabelVolume volume = numbered();
  check_same((write_labels(file.path, volume), read_labels(file.path)), volume);
  volume.origin_world = {7, -8, 9.5};
  volume.step_world = {WorldPoint{-2, 0, 0}, {0, 3e-3, 0}, {0, 0, 50}};
  check_same((write_labels(file.path, volume, {"seg", true}), read_labels(file.path, {"seg", 0})), volume);
  volume.step_world = {WorldPoint{1, 2, 0}, {-2, 1, .5}, {.25, 0, 3}};
  check_same((write_labels(file.path, volume, {"", true}), read_labels(file.path)), volume);
  CHECK(error_of([&] { write_labels(file.path, volume); }).code() == ErrorCode::unwritable_output);
}

TEST_CASE("labels: the array is the box of what is active or no background, tiles and scattered voxels too",
          "[labels][unit]") {
  const TemporaryFile file("sparse.vdb");
  const auto grid = new_grid<openvdb::Int32Grid>("seg", 5);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(-8), openvdb::Coord(-1)), 2);  // a tile
  grid->tree().setValueOn(openvdb::Coord(3, 0, -20), 5);                      // active background
  grid->tree().setValueOff(openvdb::Coord(0, 30, 4), 9);                      // inactive, but another value
  grid->tree().setValueOff(openvdb::Coord(100, 100, 100), 5);                 // neither
  write(file.path, {grid});
  const LabelVolume volume = read_labels(file.path);
  CHECK(volume.background == 5);
  CHECK(volume.size_vox == std::array<int32_t, 3>{12, 39, 25});
  CHECK((volume.origin_world.x == -8 && volume.origin_world.y == -8 && volume.origin_world.z == -20));
  CHECK(label_at(volume, 8, 38, 24) == 9);
  CHECK(label_at(volume, 11, 8, 0) == 5);
  int64_t of_tile = 0;
  for (const int32_t label : volume.labels) of_tile += label == 2;
  CHECK(of_tile == 512);
  CHECK(label_at(volume, 0, 0, 12) == 2);
  CHECK(label_at(volume, 7, 7, 19) == 2);
}

TEST_CASE("labels: integers of 64 bits are read where they fit 32, and refused with their voxel where not",
          "[labels][unit]") {
  const TemporaryFile file("wide.vdb");
  const auto grid = new_grid<openvdb::Int64Grid>("ids", 0);
  grid->tree().setValueOn(openvdb::Coord(1, 2, 3), INT32_MIN);
  grid->tree().setValueOn(openvdb::Coord(1, 2, 4), INT32_MAX);
  write(file.path, {grid});
  CHECK(read_labels(file.path).labels == std::vector<int32_t>{INT32_MIN, INT32_MAX});
  grid->tree().setValueOn(openvdb::Coord(-100, 2, 4), int64_t(1) << 31);
  grid->tree().setValueOn(openvdb::Coord(100, 2, 4), int64_t(1) << 31);
  write(file.path, {grid});
  CHECK(refusal(file.path).code() == ErrorCode::unreadable_input);
  CHECK(says(refusal(file.path), "grid \"ids\": voxel [-100, 2, 4] has the value 2147483648"));
  const auto far = new_grid<openvdb::Int64Grid>("far", -(int64_t(1) << 40));
  far->tree().setValueOn(openvdb::Coord(0), 1);
  write(file.path, {far});
  CHECK(says(refusal(file.path), "background"));
}

TEST_CASE("labels: names are metadata label:7 of type string, and nothing else is", "[labels][unit]") {
  const TemporaryFile file("named.vdb");
  const auto grid = new_grid<openvdb::Int32Grid>("seg", 0);
  grid->tree().setValueOn(openvdb::Coord(0), 7);
  for (const char* key : {"label:12", "label:7", "label:-3", "label:07", "label:x", "label:", "label:99999999999"})
    grid->insertMeta(key, openvdb::StringMetadata(std::string("name of ") + key));
  grid->insertMeta("label:8", openvdb::Int32Metadata(1));
  grid->insertMeta("label:9", openvdb::StringMetadata(""));
  write(file.path, {grid});
  const LabelVolume volume = read_labels(file.path);
  REQUIRE(volume.names.size() == 3);
  CHECK(volume.names[0].label == -3);
  CHECK(volume.names[1].label == 7);
  CHECK(volume.names[2].label == 12);
  CHECK(volume.names[1].name == "name of label:7");
}

TEST_CASE("labels: a file without labels, several grids, and one without voxels say what there is", "[labels][unit]") {
  const TemporaryFile file("several.vdb");
  const auto fog = new_grid<openvdb::FloatGrid>("fog", 0);
  fog->tree().setValueOn(openvdb::Coord(0), 1);
  write(file.path, {fog});
  CHECK(refusal(file.path).code() == ErrorCode::nothing_to_mesh);
  CHECK(says(refusal(file.path), "holds no grid of labels; \"fog\" (float, unknown) holds no labels"));
  const auto empty = new_grid<openvdb::Int32Grid>("empty", 3), full = new_grid<openvdb::Int32Grid>("full", 3);
  full->tree().setValueOn(openvdb::Coord(0), 1);
  write(file.path, {fog, empty, full});
  CHECK(refusal(file.path).code() == ErrorCode::usage);
  CHECK(says(refusal(file.path), "name one as " + file.path + ":empty"));
  CHECK(says(refusal(file.path, {"wind", 0}), "has no grid \"wind\""));
  CHECK(refusal(file.path, {"fog", 0}).code() == ErrorCode::nothing_to_mesh);
  CHECK(refusal(file.path, {"empty", 0}).code() == ErrorCode::nothing_to_mesh);
  CHECK(says(refusal(file.path, {"empty", 0}), "holds no labels: all its voxels are inactive"));
  CHECK(read_labels(file.path, {"full", 0}).labels == std::vector<int32_t>{1});
  VolumeInfo info;
  CHECK(says(error_of([&] { read_volume(file.path, {"full", {}, 0}, info); }), "labels of regions"));
}

TEST_CASE("labels: a grid over the memory limit is refused before its array is made", "[labels][unit]") {
  const TemporaryFile file("far.vdb");
  const auto grid = new_grid<openvdb::Int32Grid>("seg", 0);
  grid->tree().setValueOn(openvdb::Coord(0), 1);
  write(file.path, {grid});
  CHECK(read_labels(file.path, {"", 1 << 20}).labels.size() == 1);
  CHECK(says(refusal(file.path, {"", 1 << 16}), "more than the limit of 0 MiB"));
  grid->tree().setValueOn(openvdb::Coord(2000000000), 1);
  grid->tree().setValueOn(openvdb::Coord(-2000000000), 1);
  write(file.path, {grid});
  for (const int64_t limit : {int64_t(0), int64_t(1) << 30}) {
    CHECK(refusal(file.path, {"", limit}).code() == ErrorCode::out_of_memory);
    CHECK(says(refusal(file.path, {"", limit}), "grid \"seg\" (int32, unknown)"));
  }
  CHECK(says(refusal(file.path, {"", 1 << 30}), "more than the limit of 1024 MiB"));
}

TEST_CASE("labels: a grid of labels is an input, where it is named or the file holds no volume", "[labels][unit]") {
  const TemporaryFile file("input.vdb");
  const auto seg = new_grid<openvdb::Int32Grid>("seg", 0);
  seg->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(4)), 3);
  seg->fill(openvdb::CoordBBox(openvdb::Coord(5, 0, 0), openvdb::Coord(9, 4, 4)), 7);
  seg->setTransform(openvdb::math::Transform::createLinearTransform(.5));
  seg->insertMeta("label:7", openvdb::StringMetadata("femur"));
  const auto fog = new_grid<openvdb::FloatGrid>("fog", 0);
  fog->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(4)), 1);
  const auto flags = new_grid<openvdb::BoolGrid>("flags", false);
  std::string said;
  const Tell tell = [&](MessageKind, const std::string& text) { said += text + "\n"; };
  write(file.path, {flags, seg});
  const Input input = read_input(named_input(file.path), 0, tell);
  CHECK(input.facts.kind == InputKind::labels);
  CHECK(contains(said, file.path + ": grid seg, 2 regions, 10 x 5 x 5 voxels"));
  CHECK(input.soup.regions.labels.size() == input.soup.triangles.size());
  REQUIRE(input.soup.regions.names.size() == 1);
  CHECK(input.soup.regions.names[0].name == "femur");
  CHECK((input.facts.box_max && std::abs(input.facts.box_max->x - 4.75) < .3));
  InputRequest request = named_input(file.path);
  request.iso = .5;
  CHECK(says(error_of([&] { read_input(request, 0); }), "--iso is for volumes"));
  CHECK(error_of([&] { read_input(named_input(file.path + ":flags"), 0); }).code() == ErrorCode::nothing_to_mesh);
  CHECK(error_of([&] { read_input(named_input(file.path), 1 << 16); }).code() == ErrorCode::out_of_memory);
  write(file.path, {fog, seg});
  CHECK(read_input(request, 0).facts.kind == InputKind::volume);
  CHECK(read_input(named_input(file.path + ":seg"), 0).facts.kind == InputKind::labels);
}

TEST_CASE("labels: the background may be another label than the grid's", "[labels][unit]") {
  const TemporaryFile file("background.vdb");
  const auto grid = new_grid<openvdb::Int64Grid>("seg", int64_t(1) << 40);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(9, 4, 4)), 9);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(2, 1, 1), openvdb::Coord(4, 3, 3)), 3);
  grid->tree().setValueOff(openvdb::Coord(7, 2, 2), int64_t(1) << 40);
  write(file.path, {grid});
  CHECK(says(refusal(file.path), "say by --background which label is no region"));
  LabelReadOptions options;
  options.background = 9;
  const LabelVolume volume = read_labels(file.path, options);
  CHECK(volume.background == 9);
  CHECK(std::count(volume.labels.begin(), volume.labels.end(), 3) == 27);
  CHECK(std::count(volume.labels.begin(), volume.labels.end(), 9) == 250 - 27);
}

TEST_CASE("labels: an input says how labels are read, and what is no volume of labels refuses it", "[labels][unit]") {
  const TemporaryFile file("islands.vdb");
  const auto seg = new_grid<openvdb::Int32Grid>("seg", 0);
  seg->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(9)), 3);
  seg->fill(openvdb::CoordBBox(openvdb::Coord(4), openvdb::Coord(5)), 0);
  seg->fill(openvdb::CoordBBox(openvdb::Coord(0, 0, 20), openvdb::Coord(9, 9, 29)), 7);
  seg->fill(openvdb::CoordBBox(openvdb::Coord(0, 0, 25), openvdb::Coord(0, 0, 25)), 3);
  write(file.path, {seg});
  InputRequest request = named_input(file.path);
  const size_t walls = read_input(request, 0).soup.triangles.size();
  request.labels.smallest_island_vox = 0;
  const size_t all_walls = read_input(request, 0).soup.triangles.size();
  request.labels.smallest_island_vox = 9;
  const size_t large_walls = read_input(request, 0).soup.triangles.size();
  CHECK(all_walls > walls);
  CHECK(walls > large_walls);
  request.labels.background = 3;
  CHECK(read_input(request, 0).soup.regions.background == 3);
  CHECK(named_input("other.vdb:seg", request).labels.background == 3);
  const auto fog = new_grid<openvdb::FloatGrid>("fog", 0);
  fog->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(4)), 1);
  write(file.path, {fog});
  request.iso = .5;
  CHECK(says(error_of([&] { read_input(request, 0); }), "--background is for volumes of labels"));
  request.labels.background.reset();
  CHECK(says(error_of([&] { read_input(request, 0); }), "--smallest-island is for volumes of labels"));
  request.labels.smallest_island_vox.reset();
  request.labels.smoothing_vox = 0;
  CHECK(says(error_of([&] { read_input(request, 0); }), "--smoothing is for volumes of labels"));
}

TEST_CASE("labels: transforms that are frustums are refused", "[labels][unit]") {
  const TemporaryFile file("frustum.vdb");
  const auto grid = new_grid<openvdb::Int32Grid>("seg", 0);
  grid->tree().setValueOn(openvdb::Coord(0), 1);
  grid->setTransform(openvdb::math::Transform::createFrustumTransform(openvdb::BBoxd({0, 0, 0}, {9, 9, 9}), .5, 10));
  write(file.path, {grid});
  CHECK(refusal(file.path).code() == ErrorCode::unreadable_input);
  CHECK(says(refusal(file.path), "only linear ones are read"));
}

TEST_CASE("labels: a file cut anywhere, or with a changed byte, is read or refused", "[labels][unit]") {
  const TemporaryFile file("damaged.vdb");
  write_labels(file.path, numbered());
  std::ifstream in(file.path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  const LabelReadOptions options{"", 64 << 20};
  for (size_t cut = 0; cut < whole.size(); cut += 1 + cut / 8) {
    std::ofstream(file.path, std::ios::binary | std::ios::trunc).write(whole.data(), std::streamsize(cut));
    REQUIRE_THROWS_AS(read_labels(file.path, options), Error);
  }
  for (size_t at = 0; at < whole.size(); at += 1 + at / 16) {
    std::string changed = whole;
    changed[at] = char(changed[at] ^ 0x41);
    std::ofstream(file.path, std::ios::binary | std::ios::trunc).write(changed.data(), std::streamsize(whole.size()));
    try {
      read_labels(file.path, options);
    } catch (const Error& error) {
      REQUIRE(error.code() != ErrorCode::internal);
    }
  }
}

TEST_CASE("labels: volumes that no file can hold are refused before anything is written", "[labels][unit]") {
  const TemporaryFile file("none.vdb");
  LabelVolume volume = numbered();
  volume.labels.pop_back();
  CHECK(says(error_of([&] { write_labels(file.path, volume); }), "1682 labels for 11 x 9 x 17 voxels"));
  CHECK(says(error_of([&] { write_labels(file.path, LabelVolume{}); }), "no voxels"));
  volume = numbered();
  volume.step_world[1] = volume.step_world[0];
  CHECK(error_of([&] { write_labels(file.path, volume); }).code() == ErrorCode::usage);
  CHECK_FALSE(std::ifstream(file.path).good());
}
