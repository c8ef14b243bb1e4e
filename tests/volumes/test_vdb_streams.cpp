// .vdb streams, which have no offsets: what a file gives, they give, and no damage does harm.
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>

#include <cstring>
#include <fstream>
#include <sstream>

#include "isoshell/error.h"
#include "isoshell/io/label_file.h"
#include "isoshell/io/volume_file.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/temporary_file.h"

using namespace isoshell;

namespace {

openvdb::FloatGrid::Ptr ball() {
  auto grid = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(9.2f, openvdb::Vec3f(3, -4, 5), 0.5f);
  grid->setName("ball");
  return grid;
}

/// With leaves, tiles and a background of their own.
template <class Grid>
typename Grid::Ptr grid_of(const char* name, const typename Grid::ValueType& value) {
  auto grid = Grid::create();
  grid->setName(name);
  grid->fill(openvdb::CoordBBox(openvdb::Coord(-3), openvdb::Coord(40)), value);
  return grid;
}

/// Of all kinds that can be walked, the ball among them; one shares the tree of another.
openvdb::GridPtrVec many_grids() {
  const auto half = grid_of<openvdb::DoubleGrid>("half", 0.25);
  half->setSaveFloatAsHalf(true);
  const auto speed = grid_of<openvdb::Vec3SGrid>("speed", openvdb::Vec3f(1, 2, 3));
  const auto same = openvdb::Vec3SGrid::create(speed->treePtr());
  same->setName("same");
  auto mask = openvdb::MaskGrid::create();
  mask->setName("mask");
  mask->sparseFill(openvdb::CoordBBox(openvdb::Coord(-3), openvdb::Coord(40)), true);
  const auto half_flags = grid_of<openvdb::BoolGrid>("half flags", true);
  half_flags->setSaveFloatAsHalf(true);  // which is in the name of its type
  return {grid_of<openvdb::BoolGrid>("flags", true),
          half_flags,
          mask,
          half,
          grid_of<openvdb::Int32Grid>("ids", 7),
          speed,
          same,
          grid_of<openvdb::Int64Grid>("big", 8),
          ball()};
}

std::string stream_of(const openvdb::GridPtrVec& grids, uint32_t compression) {
  std::ostringstream out(std::ios::binary);
  openvdb::io::Stream stream(out);
  stream.setCompression(compression);
  openvdb::MetaMap meta;
  meta.insertMeta("shot", openvdb::StringMetadata("a12"));
  stream.write(grids, meta);
  return out.str();
}

void write(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc).write(bytes.data(), std::streamsize(bytes.size()));
}

TriangleSoup read(const std::string& path, const std::string& grid = "") {
  VolumeInfo info;
  return read_volume(path, {grid, {}, 64 << 20}, info);
}

}  // namespace

TEST_CASE("vdb stream: packed or not, it gives the surface of the file, behind grids of every kind",
          "[volume][stage]") {
  const TemporaryFile stream("stream.vdb"), file("file.vdb");
  openvdb::initialize();
  for (const uint32_t compression : {0u, 1u, 2u, 4u, 6u}) {
    openvdb::io::File(file.path).write({ball()});
    const TriangleSoup soup = read(file.path);
    write(stream.path, stream_of({ball()}, compression));
    CHECK(read(stream.path).triangles == soup.triangles);
    write(stream.path, stream_of(many_grids(), compression));
    const TriangleSoup last = read(stream.path, "ball");
    CHECK(last.triangles == soup.triangles);
    CHECK(std::memcmp(last.vertices.data(), soup.vertices.data(), soup.vertices.size() * sizeof(WorldPoint)) == 0);
    CHECK(read_labels(stream.path, {"ids", 64 << 20}).labels.size() == size_t(44 * 44 * 44));
  }
}

TEST_CASE("vdb stream: a grid whose end nothing tells is refused with a remedy", "[volume][stage]") {
  const TemporaryFile file("text.vdb");
  openvdb::initialize();
  using TextTree = openvdb::tree::Tree4<std::string, 5, 4, 3>::Type;
  using TextGrid = openvdb::Grid<TextTree>;
  if (!TextGrid::isRegistered()) TextGrid::registerGrid();
  auto words = TextGrid::create("none");
  words->setName("words");
  write(file.path, stream_of({words, ball()}, 0));
  const Error refused = error_of([&] { read(file.path); });
  CHECK(refused.code() == ErrorCode::unreadable_input);
  CHECK(says(refused, "grid \"words\""));
  CHECK(says(refused, "leave it out, or write a file"));
}

TEST_CASE("vdb stream: cut anywhere, or with a changed byte, it is read or refused", "[volume][stage]") {
  const TemporaryFile file("damaged.vdb");
  openvdb::initialize();
  const std::string whole = stream_of(many_grids(), openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
  for (size_t cut = 0; cut < whole.size(); cut += 1 + cut / 8) {
    write(file.path, whole.substr(0, cut));
    REQUIRE_THROWS_AS(read(file.path, "ball"), Error);
  }
  for (size_t at = 0; at < whole.size(); at += 1 + at / 32) {
    std::string changed = whole;
    changed[at] = char(changed[at] ^ 0x41);
    write(file.path, changed);
    try {
      read(file.path, "ball");
    } catch (const Error& error) {
      REQUIRE(error.code() != ErrorCode::internal);
    }
  }
  write(file.path, whole + "more");
  CHECK(says(error_of([&] { read(file.path, "ball"); }), "it is damaged"));
}
