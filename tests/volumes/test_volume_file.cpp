// Volumes as files: every kind of level set gives its surface, everything else says why not, and no damage does harm.
#include <openvdb/openvdb.h>
#include <openvdb/tools/ChangeBackground.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#if __has_include(<nanovdb/util/OpenToNanoVDB.h>)
#include <nanovdb/util/IO.h>
#include <nanovdb/util/OpenToNanoVDB.h>
#define ISOSHELL_TEST_NANO
#endif
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "isoshell/io/volume_file.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/temporary_file.h"

using namespace isoshell;

namespace {

constexpr double kRadius = 9.2;
const openvdb::Vec3f kCentre(3, -4, 5);

openvdb::FloatGrid::Ptr ball(double half_width = 3) {
  auto grid =
      openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(float(kRadius), kCentre, 0.5f, float(half_width));
  grid->setName("ball");
  return grid;
}

void write(const std::string& path, const openvdb::GridPtrVec& grids,
           uint32_t compression = openvdb::io::COMPRESS_ZIP | openvdb::io::COMPRESS_ACTIVE_MASK) {
  openvdb::io::File file(path);
  file.setCompression(compression);
  file.write(grids);
}

TriangleSoup read(const std::string& path, const VolumeReadOptions& options = {}) {
  VolumeInfo info;
  return read_volume(path, options, info);
}

Error refusal(const std::string& path, const VolumeReadOptions& options = {}) {
  return error_of([&] { read(path, options); });
}

bool is_closed(const TriangleSoup& soup) {
  Context context;
  const InputTopology t = measure_topology(soup, context).topology;
  return t.closed && t.oriented && t.components == 1 && t.genus == 0;
}

/// Largest distance of a vertex from the ball.
double distance_of(const TriangleSoup& soup) {
  double worst = 0;
  for (const WorldPoint& p : soup.vertices) {
    const double x = p.x - kCentre.x(), y = p.y - kCentre.y(), z = p.z - kCentre.z();
    worst = std::max(worst, std::abs(std::sqrt(x * x + y * y + z * z) - kRadius));
  }
  return worst;
}

}  // namespace

TEST_CASE("volume: a level set of any half-width, as floats or halves, packed or not, is its ball", "[volume][stage]") {
  const TemporaryFile file("ball.vdb");
  for (const double half_width : {1.1, 3.0, 8.0})
    for (const bool as_half : {false, true})
      for (const uint32_t compression : {0u, 1u, 2u, 4u, 6u}) {
        const auto grid = ball(half_width);
        grid->setSaveFloatAsHalf(as_half);
        write(file.path, {grid}, compression);
        const TriangleSoup soup = read(file.path);
        REQUIRE(is_closed(soup));
        REQUIRE(distance_of(soup) < 0.0136);  // h^2 / (2 r)
      }
}

TEST_CASE("volume: rotated, sheared and mirrored transforms put the surface where they say, outward",
          "[volume][stage]") {
  const TemporaryFile file("turned.vdb");
  const auto grid = ball();
  openvdb::math::Mat4d turn = openvdb::math::Mat4d::identity();
  turn.postRotate(openvdb::math::Y_AXIS, 0.7);
  turn.postScale(openvdb::Vec3d(-1, 2, 1));
  turn.postTranslate(openvdb::Vec3d(100, 0, -7));
  grid->transform().postMult(turn);
  write(file.path, {grid});
  TriangleSoup soup = read(file.path);
  CHECK(is_closed(soup));
  double six = 0;
  for (const auto& t : soup.triangles) {
    const WorldPoint &a = soup.vertices[t[0]], &b = soup.vertices[t[1]], &c = soup.vertices[t[2]];
    six += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  }
  CHECK(six > 0);
  for (WorldPoint& p : soup.vertices) {
    const openvdb::Vec3d back = turn.inverse().transform(openvdb::Vec3d(p.x, p.y, p.z));
    p = {back.x(), back.y(), back.z()};
  }
  CHECK(distance_of(soup) < 0.0136);
}

TEST_CASE("volume: voxels of any size put the surface where they say", "[volume][stage]") {
  const TemporaryFile file(".vdb");
  for (const double size : {2e-5, 1e6}) {
    const openvdb::FloatGrid::Ptr grid = ball();
    grid->setTransform(openvdb::math::Transform::createLinearTransform(size));
    write(file.path, {grid});
    TriangleSoup soup = read(file.path);
    for (WorldPoint& p : soup.vertices) p = {p.x / size / 2, p.y / size / 2, p.z / size / 2};
    INFO("voxels of " << size);
    CHECK(is_closed(soup));
    CHECK(distance_of(soup) < .05);
  }
}

TEST_CASE("volume: a fog volume needs an iso value and a file of several grids a name", "[volume][stage]") {
  const TemporaryFile file("several.vdb");
  auto fog = ball();
  fog->setName("fog");
  openvdb::tools::sdfToFogVolume(*fog);
  auto flags = openvdb::BoolGrid::create(), empty = openvdb::BoolGrid::create();
  flags->setName("flags");
  flags->fill(openvdb::CoordBBox(openvdb::Coord(0), openvdb::Coord(9)), true);
  auto speed = openvdb::Vec3SGrid::create();
  speed->setName("speed");
  auto nothing = openvdb::FloatGrid::create(1);
  nothing->setName("nothing");
  write(file.path, {fog, flags, speed, nothing});
  CHECK(refusal(file.path).code() == ErrorCode::usage);
  CHECK(says(refusal(file.path), "\"fog\" (float, fog volume), \"flags\" (bool"));
  CHECK(says(refusal(file.path, {"fog", {}, 0}), "--iso 0.5"));
  CHECK(is_closed(read(file.path, {"fog", 0.5, 0})));
  CHECK(refusal(file.path, {"fog", 1.5, 0}).code() == ErrorCode::nothing_to_mesh);
  CHECK(refusal(file.path, {"flags", {}, 0}).code() == ErrorCode::nothing_to_mesh);
  CHECK(says(refusal(file.path, {"speed", {}, 0}), "vectors"));
  CHECK(says(refusal(file.path, {"nothing", {}, 0}), "all its values are 1"));
  CHECK(says(refusal(file.path, {"wind", {}, 0}), "no grid \"wind\""));
  write(file.path, {fog, ball()});
  CHECK(distance_of(read(file.path)) < 0.0136);  // the only level set
}

TEST_CASE("volume: grids of the same name, or of none, are told apart by number", "[volume][stage]") {
  const TemporaryFile file("same.vdb");
  const auto plain = ball(), thick = ball(5);
  openvdb::tools::sdfToFogVolume(*thick);
  for (const std::string name : {"d", ""}) {
    plain->setName(name);
    thick->setName(name);
    write(file.path, {plain, plain->deepCopy(), thick});
    const Error several = refusal(file.path, {name, {}, 0});
    CHECK(several.code() == ErrorCode::usage);
    CHECK(says(several, file.path + ":" + name + "[0]"));
    CHECK(says(several, "\"" + name + "[2]\" (float, fog volume)"));
    CHECK(distance_of(read(file.path, {name + "[1]", {}, 0})) < .01);
    CHECK(is_closed(read(file.path, {name + "[2]", .5f, 0})));
    CHECK(refusal(file.path, {name + "[3]", {}, 0}).code() == ErrorCode::usage);
    CHECK(refusal(file.path, {name + "[2]", {}, 0}).code() == ErrorCode::usage);
  }
}

TEST_CASE("volume: a grid that is called as another would be numbered keeps its name", "[volume][stage]") {
  const TemporaryFile file("literal.vdb");
  std::vector<openvdb::GridBase::Ptr> grids;
  for (const char* name : {"d", "d[1]", "d", "d[3]", "d"}) {
    auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(float(grids.size()) + 4, kCentre, 0.5f);
    grid->setName(name);
    grids.push_back(grid);
  }
  write(file.path, grids);
  const auto radius_of = [&](const std::string& grid) {
    const auto [lo, hi] = bounding_box(read(file.path, {grid, {}, 0}));
    return std::lround((hi.x - lo.x) / 2);
  };
  CHECK(radius_of("d[0]") == 4);
  CHECK(radius_of("d[1]") == 5);
  CHECK(radius_of("d[2]") == 6);
  CHECK(radius_of("d[3]") == 7);
  CHECK(radius_of("d[4]") == 8);
  const Error several = refusal(file.path, {"d", {}, 0});
  CHECK(says(several, file.path + ":d[0]"));
  for (const char* name : {"\"d[0]\"", "\"d[1]\"", "\"d[2]\"", "\"d[3]\"", "\"d[4]\""}) CHECK(says(several, name));
}

TEST_CASE("volume: a grid over the memory limit is refused before it is read", "[volume][stage]") {
  const TemporaryFile file("large.vdb");
  write(file.path, {ball()});
  const Error large = refusal(file.path, {"", {}, 1 << 20});
  CHECK(large.code() == ErrorCode::out_of_memory);
  CHECK(says(large, "--max-memory"));
  CHECK_NOTHROW(read(file.path, {"", {}, 64 << 20}));
}

TEST_CASE("volume: a file cut anywhere, or with a changed byte, is read or refused", "[volume][stage]") {
  const TemporaryFile file("damaged.vdb");
  write(file.path, {ball()});
  std::ifstream in(file.path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (size_t cut = 0; cut < whole.size(); cut += 1 + cut / 8) {
    std::ofstream(file.path, std::ios::binary | std::ios::trunc).write(whole.data(), std::streamsize(cut));
    REQUIRE_THROWS_AS(read(file.path), Error);
  }
  for (size_t at = 0; at < whole.size(); at += 1 + at / 16) {
    std::string changed = whole;
    changed[at] = char(changed[at] ^ 0x41);
    std::ofstream(file.path, std::ios::binary | std::ios::trunc).write(changed.data(), std::streamsize(whole.size()));
    try {
      read(file.path);
    } catch (const Error& error) {
      REQUIRE(error.code() != ErrorCode::internal);
    }
  }
}

TEST_CASE(
    "volume: a level set whose background is 0 is the surface that it is with another, whatever lies outside of it",
    "[volume][stage]") {
  const TemporaryFile file("zero.vdb"), usual("usual.vdb");
  for (const double half_width : {1.1, 3.0, 8.0}) {
    write(usual.path, {ball(half_width)});
    const auto zero = ball(half_width);
    openvdb::tools::changeBackground(zero->tree(), 0.f);  // inside and outside alike
    REQUIRE(zero->tree().getValue({6, -8, 10}) == 0);
    write(file.path, {zero});
    const TriangleSoup soup = read(file.path);
    CHECK(is_closed(soup));
    CHECK(soup.triangles.size() == read(usual.path).triangles.size());
    CHECK(distance_of(soup) < 0.0136);
    VolumeReadOptions outer;
    outer.iso = 0.3;
    if (half_width >= 3) CHECK(distance_of(read(file.path, outer)) == Approx(0.3).margin(0.02));
#ifdef ISOSHELL_TEST_NANO
    const TemporaryFile nano("zero.nvdb");
    nanovdb::io::writeGrid(nano.path, nanovdb::openToNanoVDB(*zero));
    CHECK(read(nano.path).triangles == soup.triangles);
    nanovdb::io::writeGrid(nano.path,
                           nanovdb::openToNanoVDB<nanovdb::HostBuffer, openvdb::FloatTree, nanovdb::Fp8>(*zero));
    CHECK(is_closed(read(nano.path)));
    CHECK(distance_of(read(nano.path)) < 0.03);
#endif
  }
}

#ifdef ISOSHELL_TEST_NANO
TEST_CASE("volume: a .nvdb file gives the surface of the .vdb file, and no offset in it is trusted",
          "[volume][stage]") {
  const TemporaryFile vdb("same.vdb"), nano("same.nvdb");
  const auto grid = ball();
  write(vdb.path, {grid}, 0);
  const auto handle = nanovdb::openToNanoVDB(*grid);
  nanovdb::io::writeGrid(nano.path, handle);
  const TriangleSoup soup = read(nano.path);
  CHECK(soup.triangles == read(vdb.path).triangles);
  CHECK(distance_of(soup) < 0.0136);
  std::ifstream in(nano.path, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(in), {}};
  for (size_t at = 0; at < whole.size(); at += 1 + at / 16) {
    std::string changed = whole;
    changed[at] = char(changed[at] ^ 0x41);
    std::ofstream(nano.path, std::ios::binary | std::ios::trunc).write(changed.data(), std::streamsize(whole.size()));
    try {
      read(nano.path);
    } catch (const Error& error) {
      REQUIRE(error.code() != ErrorCode::internal);
    }
  }
  std::ofstream(nano.path, std::ios::binary | std::ios::trunc).write(whole.data(), std::streamsize(whole.size() / 2));
  CHECK(refusal(nano.path).code() == ErrorCode::unreadable_input);
}
#endif
