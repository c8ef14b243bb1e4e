// Stage files: what is saved comes back, equal saves are equal bytes, and no damage goes unnoticed or does harm.
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <string>

#include "core/voxel_set.h"
#include "io/vdb/vdb_layout.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "isoshell/io/vdb_file.h"
#include "support/catch.h"
#include "support/temporary_file.h"
#include "support/test_context.h"
#include "voxel/leaf.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

std::string bytes_of(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void put_bytes(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc).write(bytes.data(), std::streamsize(bytes.size()));
}

VoxelSet voxel_set(const std::map<uint64_t, LeafMask>& leaves, const int32_t extent_vox[3]) {
  VoxelSet set;
  set.leaf_key = Buffer<uint64_t>(int64_t(leaves.size()));
  set.mask = Buffer<LeafMask>(int64_t(leaves.size()));
  int64_t l = 0;
  for (const auto& [key, mask] : leaves) {
    set.leaf_key[l] = key;
    set.mask[l++] = mask;
  }
  index_host_leaves(set, extent_vox);
  return set;
}

/// Products that fit one another in size, with values from a counter: a file format does not ask what they mean.
struct Products {
  LatticeSurface surface;
  SiteSet sites;
  SiteSamples samples;
  Shell shell;
  SeedSet seeds;
  VoronoiLabels labels;
};

Products make_products(int64_t site_count, int64_t point_count, int64_t seed_count) {
  Products p;
  p.surface.frame = LatticeFrame::around({-1.25, 2, 3.1}, {4.5, 3.7, 9.3}, 100);
  p.surface.topology = {true, false, 3, 1, -4, 7, 12.3456789};
  const LatticeFrame& frame = p.surface.frame;
  uint64_t counter = 0;
  const auto random = [&](uint32_t below) { return uint32_t(random_bits(7, counter++) % below); };

  std::map<uint64_t, LeafMask> leaves;
  for (int64_t i = 0; i < site_count; ++i) {
    int32_t at[3];
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = kMarginVox + int32_t(random(uint32_t(frame.extent_vox[axis] - 2 * kMarginVox)));
    const Voxel v{at[0], at[1], at[2]};
    const int offset = offset_in_leaf(v);
    leaves[leaf_key(leaf_of_voxel(v))].word[offset >> 6] |= uint64_t(1) << (offset & 63);
  }
  p.sites.voxels = voxel_set(leaves, frame.extent_vox);
  const int64_t sites = p.sites.voxels.voxel_count();
  p.samples.sample = Buffer<SiteSample>(sites);
  for (auto& s : p.samples.sample)
    s = {int16_t(int(random(257)) - 128),
         int16_t(int(random(257)) - 128),
         int16_t(int(random(257)) - 128),
         {0, 0, 127},
         {},
         0};

  p.surface.points = Buffer<PointQ8>(point_count);
  for (auto& q : p.surface.points)
    q = {int32_t(random(uint32_t(frame.extent_vox[0] * 256))), int32_t(random(uint32_t(frame.extent_vox[1] * 256))),
         int32_t(random(uint32_t(frame.extent_vox[2] * 256)))};
  p.surface.triangles = Buffer<TriangleIndices>(2 * point_count);
  p.surface.source_face = Buffer<uint32_t>(2 * point_count);
  for (auto& t : p.surface.triangles)
    t = {random(uint32_t(point_count)), random(uint32_t(point_count)), random(uint32_t(point_count))};
  for (auto& f : p.surface.source_face) f = random(0xffffffffu);

  TestContext context;
  p.shell = build_shell(p.sites, {2}, context);
  p.seeds.position = Buffer<PointQ8>(seed_count);
  p.seeds.normal = Buffer<Normal8>(seed_count);
  p.seeds.home = Buffer<uint32_t>(seed_count);
  for (int64_t i = 0; i < seed_count; ++i) {
    p.seeds.position[i] = p.surface.points[i % point_count];
    p.seeds.normal[i] = {int8_t(int(random(255)) - 127), -127, 127};
    p.seeds.home[i] = random(0xffffffffu);
  }
  p.labels.voxel_seed = Buffer<uint32_t>(p.shell.voxels.voxel_count());
  for (auto& label : p.labels.voxel_seed) label = random(10) == 0 ? kNone : random(uint32_t(seed_count));
  return p;
}

StageWriteOptions some_options() {
  StageWriteOptions options;
  options.options_json = R"({"vertices": 1000})";
  options.closing_vox = 3;
  return options;
}

/// Reads and reports only whether it was refused as unreadable; anything else escapes.
bool is_refused(const std::string& path) {
  try {
    read_stage(path);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::unreadable_input) throw;
    CHECK(std::string(error.what()).find(path) != std::string::npos);
    return true;
  }
  return false;
}

}  // namespace

TEST_CASE("vdb: a shell file gives back the surface, the sites and the shell", "[vdb][stage]") {
  const TemporaryFile file("shell.vdb");
  for (const int64_t points : {3, 512, 513, 5000}) {
    const Products p = make_products(points, points, 4);
    StageWriteOptions options = some_options();
    options.overwrite = true;
    save_shell(file.path, p.surface, p.samples, p.shell, options);
    REQUIRE(is_stage_file(file.path));
    const StageFile back = read_stage(file.path);
    CHECK(digest(back.surface) == digest(p.surface));
    CHECK(digest(back.sites) == digest(p.sites));
    CHECK(digest(back.shell) == digest(p.shell));
    CHECK(std::equal(p.surface.source_face.begin(), p.surface.source_face.end(), back.surface.source_face.begin()));
    CHECK_FALSE(back.seeds);
    CHECK_FALSE(back.labels);
  }
}

TEST_CASE("vdb: a stage file gives back frame, topology and options to the last bit", "[vdb][stage]") {
  const TemporaryFile file("meta.vdb");
  Products p = make_products(50, 20, 4);
  p.surface.first_cap = 77;
  save_shell(file.path, p.surface, p.samples, p.shell, some_options());
  const StageFile back = read_stage(file.path);
  CHECK(back.surface.first_cap == 77);
  const LatticeFrame &is = back.surface.frame, &was = p.surface.frame;
  CHECK(is.origin.x == was.origin.x);
  CHECK(is.origin.y == was.origin.y);
  CHECK(is.origin.z == was.origin.z);
  CHECK(is.voxel_size == was.voxel_size);
  CHECK(is.resolution == was.resolution);
  CHECK(std::equal(is.extent_vox, is.extent_vox + 3, was.extent_vox));
  const InputTopology &t = back.surface.topology, &u = p.surface.topology;
  CHECK((t.closed == u.closed && t.oriented == u.oriented && t.components == u.components && t.euler == u.euler));
  CHECK((t.boundary_loops == u.boundary_loops && t.genus == u.genus && t.area_world == u.area_world));
  CHECK(back.info.stage == "shell");
  CHECK(back.info.format_version == 1);
  CHECK(back.info.options_json == R"({"vertices": 1000})");
  CHECK(back.info.closing_vox == 3);
  CHECK(back.info.digests.at("shell") == digest_text(digest(p.shell)));
}

TEST_CASE("vdb: a stage file whose topology no mesh can have is refused", "[vdb][stage]") {
  const TemporaryFile file("topology.vdb");
  const auto refused = [&](auto change) {
    Products p = make_products(50, 20, 4);
    change(p.surface.topology);
    StageWriteOptions options = some_options();
    options.overwrite = true;
    save_shell(file.path, p.surface, p.samples, p.shell, options);
    return is_refused(file.path);
  };
  CHECK_FALSE(refused([](InputTopology& t) { t.genus = -1; }));
  CHECK(refused([](InputTopology& t) { t.genus = -2; }));
  CHECK(refused([](InputTopology& t) { t.genus = std::numeric_limits<int64_t>::max(); }));
  CHECK(refused([](InputTopology& t) { t.euler = std::numeric_limits<int64_t>::min(); }));
  CHECK(refused([](InputTopology& t) { t.components = -1; }));
  CHECK(refused([](InputTopology& t) { t.boundary_loops = int64_t(1) << 40; }));
  CHECK(refused([](InputTopology& t) { t.area_world = -1; }));
  CHECK(refused([](InputTopology& t) { t.area_world = std::nan(""); }));
  CHECK(refused([](InputTopology& t) { t.area_world = std::numeric_limits<double>::infinity(); }));
}

TEST_CASE("vdb: a Voronoi file gives back the seeds and the labels as well", "[vdb][stage]") {
  const TemporaryFile file("voronoi.vdb");
  const Products p = make_products(3000, 700, 600);
  save_voronoi(file.path, p.surface, p.samples, p.shell, p.seeds, p.labels);
  const StageFile back = read_stage(file.path);
  REQUIRE(back.seeds);
  REQUIRE(back.labels);
  CHECK(back.info.stage == "voronoi");
  CHECK(back.info.closing_vox == -1);
  CHECK(digest(*back.seeds) == digest(p.seeds));
  CHECK(digest(*back.labels) == digest(p.labels));
  CHECK(digest(back.shell) == digest(p.shell));
  CHECK(digest(back.surface) == digest(p.surface));
}

TEST_CASE("vdb: two saves of the same products are equal byte by byte", "[vdb][stage]") {
  const TemporaryFile a("a.vdb"), b("b.vdb");
  const Products p = make_products(2000, 700, 60);
  save_voronoi(a.path, p.surface, p.samples, p.shell, p.seeds, p.labels);
  save_voronoi(b.path, p.surface, p.samples, p.shell, p.seeds, p.labels);
  CHECK(bytes_of(a.path) == bytes_of(b.path));
  StageWriteOptions again;
  again.overwrite = true;
  save_preview(a.path, p.surface.frame, p.shell, p.labels, again);
  save_preview(b.path, p.surface.frame, p.shell, p.labels, again);
  CHECK(bytes_of(a.path) == bytes_of(b.path));
}

TEST_CASE("vdb: an existing file is replaced only when asked", "[vdb][stage]") {
  const TemporaryFile file("keep.vdb");
  const Products p = make_products(20, 20, 4);
  put_bytes(file.path, "precious");
  REQUIRE_THROWS_AS(save_shell(file.path, p.surface, p.samples, p.shell), Error);
  CHECK(bytes_of(file.path) == "precious");
  REQUIRE_THROWS_AS(save_shell("/nowhere/at/all.vdb", p.surface, p.samples, p.shell), Error);
}

TEST_CASE("vdb: sites of a shell are the sites it was built from", "[vdb][stage]") {
  const Products p = make_products(1000, 10, 4);
  CHECK(digest(sites_of_shell(p.shell, p.surface.frame)) == digest(p.sites));
}

TEST_CASE("vdb: only files that carry a stage are stage files", "[vdb][stage]") {
  const TemporaryFile file("kind.vdb");
  CHECK_FALSE(is_stage_file(file.path));
  CHECK_FALSE(is_stage_file(std::filesystem::temp_directory_path().string()));
  put_bytes(file.path, "");
  CHECK_FALSE(is_stage_file(file.path));
  CHECK(is_refused(file.path));
  put_bytes(file.path, "ply\nformat ascii 1.0\n");
  CHECK_FALSE(is_stage_file(file.path));
  CHECK(is_refused(file.path));
  const Products p = make_products(20, 20, 4);
  StageWriteOptions replace;
  replace.overwrite = true;
  save_preview(file.path, p.surface.frame, p.shell, p.labels, replace);
  CHECK_FALSE(is_stage_file(file.path));
  CHECK(is_refused(file.path));
}

TEST_CASE("vdb: a truncated stage file is refused at any length", "[vdb][stage]") {
  const TemporaryFile file("cut.vdb");
  const Products p = make_products(300, 100, 40);
  save_voronoi(file.path, p.surface, p.samples, p.shell, p.seeds, p.labels);
  const std::string whole = bytes_of(file.path);
  for (size_t length = 0; length < whole.size(); length += 1 + whole.size() / 80) {
    put_bytes(file.path, whole.substr(0, length));
    INFO("cut to " << length << " of " << whole.size());
    CHECK(is_refused(file.path));
  }
  put_bytes(file.path, whole + "x");
  CHECK(is_refused(file.path));
}

TEST_CASE("vdb: a flipped bit anywhere in a stage file is refused", "[vdb][stage]") {
  const TemporaryFile file("flip.vdb");
  const Products p = make_products(300, 100, 40);
  save_voronoi(file.path, p.surface, p.samples, p.shell, p.seeds, p.labels);
  const std::string whole = bytes_of(file.path);
  for (uint64_t k = 0; k < 150; ++k) {
    const uint64_t bits = random_bits(3, k);
    const size_t at = size_t(bits % whole.size());
    if (at >= size_t(kVdbTagBegin) && at < size_t(kVdbHeaderBytes)) continue;
    std::string damaged = whole;
    damaged[at] = char(damaged[at] ^ (1 << (bits >> 61)));
    put_bytes(file.path, damaged);
    INFO("bit flipped in byte " << at << " of " << whole.size());
    CHECK(is_refused(file.path));
  }
}

TEST_CASE("vdb: without our checksum damage is refused or harmless", "[vdb][stage]") {
  const TemporaryFile file("foreign.vdb");
  const Products p = make_products(300, 100, 40);
  save_voronoi(file.path, p.surface, p.samples, p.shell, p.seeds, p.labels);
  std::string whole = bytes_of(file.path);
  whole.replace(size_t(kVdbTagBegin), size_t(kVdbTagBytes), "01234567-89ab-4def-8123-456789abcdef");
  put_bytes(file.path, whole);
  CHECK_FALSE(is_refused(file.path));
  int refused = 0;
  for (uint64_t k = 0; k < 150; ++k) {
    const uint64_t bits = random_bits(4, k);
    std::string damaged = whole;
    damaged[size_t(bits % whole.size())] = char(bits >> 56);
    put_bytes(file.path, damaged);
    INFO("byte " << bits % whole.size() << " set to " << (bits >> 56));
    try {
      const StageFile back = read_stage(file.path);
      CHECK(digest(back.shell) == digest(p.shell));
      CHECK(digest(back.surface) == digest(p.surface));
    } catch (const Error& error) {
      CHECK(error.code() == ErrorCode::unreadable_input);
      ++refused;
    }
  }
  CHECK(refused > 40);
}

TEST_CASE("vdb: a file whose tag is of another form is still read", "[vdb][stage]") {
  const TemporaryFile file("tag.vdb");
  const Products p = make_products(100, 30, 4);
  save_shell(file.path, p.surface, p.samples, p.shell);
  std::string whole = bytes_of(file.path);
  whole.replace(size_t(kVdbTagBegin), size_t(kVdbTagBytes), "~~ not at all what OpenVDB expects ~");
  put_bytes(file.path, whole);
  CHECK(digest(read_stage(file.path).shell) == digest(p.shell));
}

TEST_CASE("vdb: products that do not fit one another are not written", "[vdb][stage]") {
  const TemporaryFile file("misfit.vdb");
  Products p = make_products(20, 20, 4);
  p.samples.sample = Buffer<SiteSample>(3);
  REQUIRE_THROWS_AS(save_shell(file.path, p.surface, p.samples, p.shell), Error);
  CHECK_FALSE(std::filesystem::exists(file.path));
}
