// nano_index_grid as NanoVDB itself reads it: 32.4, or 32.6 and later.
#include <nanovdb/NanoVDB.h>

#include <iostream>  // the validators need it and do not include it
#if __has_include(<nanovdb/tools/GridValidator.h>)
#include <nanovdb/tools/GridValidator.h>
#else
#include <nanovdb/util/GridValidator.h>
#endif

#include <cstring>
#include <string>
#include <unordered_map>

#include "isoshell/advanced/stages.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/test_context.h"
#include "support/voxel_shapes.h"

using namespace isoshell;

namespace {

#if NANOVDB_MAJOR_VERSION_NUMBER > 32 || NANOVDB_MINOR_VERSION_NUMBER >= 6
using Index = nanovdb::ValueOnIndex;
#else
using Index = nanovdb::ValueIndex;
#endif
using IndexGrid = nanovdb::NanoGrid<Index>;

bool is_valid(const IndexGrid& grid) {
#if __has_include(<nanovdb/tools/GridValidator.h>)
  return nanovdb::tools::isValid(&grid, nanovdb::CheckMode::Full, true);
#else
  return nanovdb::isValid(grid, true, true);
#endif
}

LatticeFrame some_frame() {
  LatticeFrame frame;
  frame.origin = {-3.5, 10.25, 0.125};
  frame.voxel_size = 0.0625;
  return frame;
}

const IndexGrid& grid_in(const Buffer<std::byte>& bytes) { return *reinterpret_cast<const IndexGrid*>(bytes.data()); }

bool same(const nanovdb::CoordBBox& a, Voxel lo, Voxel hi) {
  return a.min() == nanovdb::Coord(lo.x, lo.y, lo.z) && a.max() == nanovdb::Coord(hi.x, hi.y, hi.z);
}

/// Smallest box around voxels, taken apart by a number for each voxel.
struct Boxes {
  std::unordered_map<uint64_t, std::pair<Voxel, Voxel>> box;
  void add(uint64_t which, Voxel v) {
    auto& [lo, hi] = box.try_emplace(which, v, v).first->second;
    lo = {std::min(lo.x, v.x), std::min(lo.y, v.y), std::min(lo.z, v.z)};
    hi = {std::max(hi.x, v.x), std::max(hi.y, v.y), std::max(hi.z, v.z)};
  }
  template <class Node>
  bool has(uint64_t which, const Node& node) const {
    const auto found = box.find(which);
    return found != box.end() && same(node.bbox(), found->second.first, found->second.second);
  }
};

uint64_t key_of(nanovdb::Coord origin) { return leaf_key({origin[0] >> 3, origin[1] >> 3, origin[2] >> 3}); }

}  // namespace

TEST_CASE("nano: the index grid is valid to NanoVDB, and a stock accessor reads canonical index + 1", "[nano][stage]") {
  for (const auto& shape : voxel_shapes::all(30)) {
    INFO(shape.name);
    const SiteSet sites = make_site_set(shape.voxels, shape.extent);
    const std::vector<Voxel> voxels = voxels_of(sites.voxels);
    const Buffer<std::byte> bytes = nano_index_grid(sites.voxels, some_frame(), "shell");
    const IndexGrid& grid = grid_in(bytes);
    CHECK(is_valid(grid));
    CHECK(grid.gridSize() == uint64_t(bytes.size()));
    CHECK(grid.activeVoxelCount() == voxels.size());
    CHECK(grid.valueCount() == voxels.size() + 1);
    CHECK(grid.gridClass() == nanovdb::GridClass::IndexGrid);
    CHECK(std::string(grid.gridName()) == "shell");
    CHECK(grid.isBreadthFirst());
    CHECK(grid.tree().nodeCount(0) == uint32_t(sites.voxels.leaf_count()));

    const auto accessor = grid.getAccessor();
    int64_t wrong = 0;
    for (size_t i = 0; i < voxels.size(); ++i) {
      const Voxel v = voxels[i];
      wrong += accessor.getValue(nanovdb::Coord(v.x, v.y, v.z)) != i + 1;
      for (int axis = 0; axis < 3; ++axis)
        for (int step = -1; step <= 1; step += 2) {
          const Voxel n = {v.x + (axis == 0) * step, v.y + (axis == 1) * step, v.z + (axis == 2) * step};
          const int64_t index = find_voxel(sites.voxels.view(), n);
          wrong += accessor.getValue(nanovdb::Coord(n.x, n.y, n.z)) != uint64_t(index + 1);
          wrong += accessor.isActive(nanovdb::Coord(n.x, n.y, n.z)) != (index >= 0);
        }
    }
    CHECK(wrong == 0);
    CHECK(accessor.getValue(nanovdb::Coord(-1, -5, 7)) == 0);
  }
}

TEST_CASE("nano: nodes lie in canonical order and carry the boxes of their active voxels", "[nano][stage]") {
  for (const auto& shape : voxel_shapes::all(30)) {
    INFO(shape.name);
    const SiteSet sites = make_site_set(shape.voxels, shape.extent);
    Boxes leaf_box, lower_box, upper_box, all;
    for (Voxel v : voxels_of(sites.voxels)) {
      const uint64_t key = leaf_key(leaf_of_voxel(v));
      leaf_box.add(key, v);
      lower_box.add(key >> 12, v);
      upper_box.add(key >> 27, v);
      all.add(0, v);
    }
    const Buffer<std::byte> bytes = nano_index_grid(sites.voxels, some_frame(), "shell");
    const IndexGrid& grid = grid_in(bytes);
    const auto& tree = grid.tree();
    int64_t wrong = 0;
    CHECK(tree.nodeCount(1) == lower_box.box.size());
    CHECK(tree.nodeCount(2) == upper_box.box.size());
    for (uint32_t n = 0; n < tree.nodeCount(0); ++n) {
      const auto& leaf = tree.getFirstNode<0>()[n];
      wrong += key_of(leaf.origin()) != sites.voxels.leaf_key[n] || !leaf_box.has(key_of(leaf.origin()), leaf);
    }
    for (uint32_t n = 0; n < tree.nodeCount(1); ++n) {
      const auto& node = tree.getFirstNode<1>()[n];
      wrong += !lower_box.has(key_of(node.origin()) >> 12, node);
    }
    for (uint32_t n = 0; n < tree.nodeCount(2); ++n) {
      const auto& node = tree.getFirstNode<2>()[n];
      wrong += !upper_box.has(key_of(node.origin()) >> 27, node);
    }
    CHECK(wrong == 0);
    CHECK(same(grid.indexBBox(), all.box[0].first, all.box[0].second));
  }
}

TEST_CASE("nano: an integer index is a voxel's centre in the world", "[nano][stage]") {
  const LatticeFrame frame = some_frame();  // all numbers here are exact in binary
  const SiteSet sites = make_site_set({{40, 41, 42}, {50, 61, 72}}, {128, 128, 128});
  const Buffer<std::byte> bytes = nano_index_grid(sites.voxels, frame, "shell");
  const IndexGrid& grid = grid_in(bytes);
  const WorldPoint centre = frame.to_world({40 * 256 + 128, 41 * 256 + 128, 42 * 256 + 128});
  const nanovdb::Vec3d world = grid.indexToWorld(nanovdb::Vec3d(40, 41, 42));
  const nanovdb::Vec3d index = grid.worldToIndex(nanovdb::Vec3d(centre.x, centre.y, centre.z));
  CHECK(world[0] == centre.x);
  CHECK(world[1] == centre.y);
  CHECK(world[2] == centre.z);
  for (int axis = 0; axis < 3; ++axis) {
    CHECK(index[axis] == 40 + axis);
    CHECK(grid.voxelSize()[axis] == frame.voxel_size);
    CHECK(grid.worldBBox()[0][axis] == world[axis]);
    CHECK(grid.worldBBox()[1][axis] == world[axis] + frame.voxel_size * (11 + 10 * axis));
  }
}

TEST_CASE("nano: the bytes depend on nothing but the arguments", "[nano][stage]") {
  const auto shape = voxel_shapes::all(20)[1];
  const SiteSet sites = make_site_set(shape.voxels, shape.extent);
  const Buffer<std::byte> first = nano_index_grid(sites.voxels, some_frame(), "shell");
  {
    Buffer<std::byte> dirt(first.size());
    std::memset(dirt.data(), 0xa5, size_t(dirt.size()));
  }
  const Buffer<std::byte> second = nano_index_grid(sites.voxels, some_frame(), "shell");
  REQUIRE(first.size() == second.size());
  CHECK(std::memcmp(first.data(), second.data(), size_t(first.size())) == 0);
}

TEST_CASE("nano: every backend makes the same bytes, from either memory", "[nano][stage]") {
  TestContext context;
  const auto same = [](const Buffer<std::byte>& a, const Buffer<std::byte>& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), size_t(a.size())) == 0;
  };
  for (const auto& shape : voxel_shapes::all(30)) {
    INFO(shape.name);
    const SiteSet sites = make_site_set(shape.voxels, shape.extent);
    const Buffer<std::byte> expected = nano_index_grid(sites.voxels, some_frame(), "shell");
    CHECK(same(nano_index_grid(sites.voxels, some_frame(), "shell", context).to_host(), expected));
    const Shell shell = build_shell(sites, {2}, context);
    CHECK(same(nano_index_grid(shell.voxels, some_frame(), nullptr, context).to_host(),
               nano_index_grid(to_host(shell).voxels, some_frame(), nullptr)));
  }
  const SiteSet none = make_site_set({}, {128, 128, 128});
  CHECK(same(nano_index_grid(none.voxels, some_frame(), "none", context).to_host(),
             nano_index_grid(none.voxels, some_frame(), "none")));
  CHECK_THROWS_AS(nano_index_grid(none.voxels, some_frame(), std::string(256, 'n').c_str(), context), Error);
}

TEST_CASE("nano: a grid without voxels is valid and empty", "[nano][stage]") {
  const SiteSet sites = make_site_set({}, {128, 128, 128});
  const Buffer<std::byte> bytes = nano_index_grid(sites.voxels, some_frame(), nullptr);
  CHECK(is_valid(grid_in(bytes)));
  CHECK(grid_in(bytes).activeVoxelCount() == 0);
  CHECK(grid_in(bytes).getAccessor().getValue(nanovdb::Coord(1, 2, 3)) == 0);
}

TEST_CASE("nano: a name that does not fit is a usage error", "[nano][stage]") {
  const SiteSet sites = make_site_set({{40, 40, 40}}, {128, 128, 128});
  CHECK_NOTHROW(nano_index_grid(sites.voxels, some_frame(), std::string(255, 'n').c_str()));
  CHECK_THROWS_AS(nano_index_grid(sites.voxels, some_frame(), std::string(256, 'n').c_str()), Error);
}
