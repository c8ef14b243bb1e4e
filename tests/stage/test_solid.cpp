// The solid that a sheet bounds against brute force, voxel by voxel, and the sites of coarser lattices.
#include <algorithm>
#include <cmath>
#include <map>

#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/stages.h"
#include "oracle/dense_solid.h"
#include "stages/sheet/sheet_body.h"
#include "support/catch.h"
#include "support/test_context.h"
#include "support/voxel_sites.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

struct Named {
  std::string name;
  std::vector<Voxel> voxels;
};

const Extent kExtent = {56, 52, 60};   // of the dense lattice
const Voxel kOffset = {100, 104, 96};  // of the dense lattice in the sparse one, so that blocks of 128 meet inside
const Extent kSparseExtent = {256, 256, 256};

/// Voxels of the middle of the lattice, 12 off its border, for which inside(x, y, z) holds, relative to the centre.
template <class Inside>
Named filled(std::string name, Inside inside) {
  Named out{std::move(name), {}};
  for (int32_t x = 12; x < kExtent[0] - 12; ++x)
    for (int32_t y = 12; y < kExtent[1] - 12; ++y)
      for (int32_t z = 12; z < kExtent[2] - 12; ++z)
        if (inside(x - kExtent[0] / 2, y - kExtent[1] / 2, z - kExtent[2] / 2)) out.voxels.push_back({x, y, z});
  return out;
}

Named noise(uint64_t seed, uint64_t percent) {
  return filled("noise " + std::to_string(seed) + " at " + std::to_string(percent), [&](int x, int y, int z) {
    return random_bits(seed, uint64_t((x + 50) * 10000 + (y + 50) * 100 + z + 50)) % 100 < percent;
  });
}

Named holed_sphere(int width) {
  return filled("sphere with holes " + std::to_string(width) + " wide", [&](int x, int y, int z) {
    const double r = std::sqrt(double(x * x + y * y + z * z));
    return std::abs(r - 11) <= 0.87 && !(2 * std::abs(x) < width && 2 * std::abs(y) < width);
  });
}

std::vector<Named> all_blobs() {
  std::vector<Named> out;
  for (uint64_t percent : {1, 5, 20, 50, 80}) out.push_back(noise(percent, percent));
  for (int width : {0, 1, 2, 3, 5, 7, 9}) out.push_back(holed_sphere(width));
  out.push_back(
      filled("diagonal wires", [](int x, int y, int z) { return (x == y && y == z) || (x == -y && z == 3); }));
  out.push_back(filled("diagonal tunnels", [](int x, int y, int z) {
    return !((x == y && y == z) || (x == -y && z == 3) || (x == 5 && y == z));
  }));
  out.push_back(filled("two walls", [](int x, int, int) { return x == -2 || x == 1; }));
  out.push_back(filled("one voxel", [](int x, int y, int z) { return x == 0 && y == 0 && z == 0; }));
  return out;
}

oracle::Dense dense_of(const std::vector<Voxel>& voxels) {
  oracle::Dense out(kExtent);
  for (Voxel v : voxels) out.value[out.at(v)] = 1;
  return out;
}

Voxel in_sparse(Voxel v) { return {v.x + kOffset.x, v.y + kOffset.y, v.z + kOffset.z}; }

SiteSet site_set_of(const Named& blob) {
  std::vector<Voxel> voxels;
  for (const Voxel v : blob.voxels) voxels.push_back(in_sparse(v));
  return make_site_set(voxels, kSparseExtent);
}

bool is_solid(const SolidView& solid, Voxel dense) {
  const Voxel v = in_sparse(dense);
  return solid.at(leaf_of_voxel(v)).word(v.x & 7) >> (offset_in_leaf(v) & 63) & 1;
}

int64_t mismatches(Solid& solid, const oracle::Dense& expected) {
  const SolidView view = solid.view();
  int64_t wrong = 0;
  expected.for_each([&](Voxel v) { wrong += is_solid(view, v) != bool(expected.get(v, 0)); });
  return wrong;
}

/// Defects of a quad mesh as the boundary of a solid: edges without exactly two opposite sides, corners with two fans.
int64_t count_defects(const QuadMesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> sides;
  std::vector<std::map<uint32_t, uint32_t>> next(size_t(mesh.corners.voxel_count()));
  int64_t defects = 0;
  for (const Quad& q : mesh.quads)
    for (int k = 0; k < 4; ++k) {
      const uint32_t a = q.corner[k], b = q.corner[(k + 1) % 4], before = q.corner[(k + 3) % 4];
      defects += sides[{a, b}]++ != 0;
      next[a][b] = before;
    }
  for (const auto& side : sides) defects += sides.count({side.first.second, side.first.first}) != 1;
  for (const auto& fan : next) {
    if (fan.empty()) {
      ++defects;
      continue;
    }
    size_t steps = 0;
    uint32_t at = fan.begin()->first;
    do {
      at = fan.at(at);
      ++steps;
    } while (at != fan.begin()->first && fan.count(at) && steps <= fan.size());
    defects += steps != fan.size();
  }
  return defects;
}

}  // namespace

TEST_CASE("sheet: the closed solid is the one of the definition, voxel by voxel", "[sheet][stage]") {
  TestContext context;
  context.backend = Backend::cpu;  // where these parts run, and what lies in their products is looked at
  CpuExecutor exec(context, "sheet");
  for (const Named& blob : all_blobs())
    for (const int32_t r : {0, 1, 2, 5}) {
      INFO(blob.name << ", r = " << r);
      const SiteSet sites = site_set_of(blob);
      Solid solid = close_sites(exec, sites, r);
      oracle::Dense expected = oracle::closed(dense_of(blob.voxels), r);
      CHECK(mismatches(solid, expected) == 0);
      make_well_composed(exec, solid);
      while (oracle::repair_once(expected)) {
      }
      CHECK(mismatches(solid, expected) == 0);
      fill_cavities(exec, solid);
      CHECK(mismatches(solid, oracle::filled(expected)) == 0);
      const QuadMesh mesh = list_boundary(exec, solid);
      CHECK(count_defects(mesh) == 0);
    }
}

TEST_CASE("sheet: hollows open the solid as far as the closing leaves them empty", "[sheet][stage]") {
  TestContext context;
  context.backend = Backend::cpu;  // where these parts run, and what lies in their products is looked at
  CpuExecutor exec(context, "sheet");
  const auto cube = [](int x, int y, int z) { return std::max({std::abs(x), std::abs(y), std::abs(z)}); };
  std::vector<Named> blobs = {noise(20, 20)};
  for (const int hollow : {1, 3})
    blobs.push_back(filled("cube with a hollow " + std::to_string(2 * hollow + 1) + " wide",
                           [&](int x, int y, int z) { return cube(x, y, z) <= 13 && cube(x, y, z) > hollow; }));
  const std::vector<Voxel> hollows = {{kExtent[0] / 2, kExtent[1] / 2, kExtent[2] / 2}, {30, 20, 35}};
  for (const Named& blob : blobs)
    for (const int32_t r : {0, 2}) {
      INFO(blob.name << ", r = " << r);
      SiteSet sites = site_set_of(blob);
      sites.hollows = Buffer<Voxel>(int64_t(hollows.size()));
      std::transform(hollows.begin(), hollows.end(), sites.hollows.begin(), in_sparse);
      Solid solid = close_sites(exec, sites, r);
      oracle::Dense expected = oracle::closed(dense_of(blob.voxels), r, hollows);
      CHECK(mismatches(solid, expected) == 0);
      make_well_composed(exec, solid);
      while (oracle::repair_once(expected)) {
      }
      fill_cavities(exec, solid, sites.hollows.view());
      CHECK(mismatches(solid, oracle::filled(expected, hollows)) == 0);
      CHECK(count_defects(list_boundary(exec, solid)) == 0);
    }
}

TEST_CASE("sheet: holes close as wide as the closing reaches", "[sheet][stage]") {
  TestContext context;
  context.backend = Backend::cpu;  // where these parts run, and what lies in their products is looked at
  CpuExecutor exec(context, "sheet");
  for (const int width : {1, 3, 5, 7})
    for (const int32_t r : {0, 1, 2, 3, 4}) {
      Solid solid = close_sites(exec, site_set_of(holed_sphere(width)), r);
      const bool is_full = is_solid(solid.view(), {kExtent[0] / 2, kExtent[1] / 2, kExtent[2] / 2});
      INFO("width " << width << ", r = " << r);
      if (width <= 2 * r) CHECK(is_full);
      if (width >= 2 * r + 3) CHECK(!is_full);
    }
}

TEST_CASE("sheet: a coarse site holds at least one site, and every site lies in one", "[sheet][stage]") {
  for (const Named& blob : all_blobs()) {
    INFO(blob.name);
    std::vector<Voxel> fine, coarse;
    for (Voxel v : blob.voxels) {
      fine.push_back({v.x + kOffset.x, v.y + kOffset.y, v.z + kOffset.z});
      coarse.push_back({fine.back().x >> 1, fine.back().y >> 1, fine.back().z >> 1});
    }
    TestContext context;
    const SiteSet sites = coarsen_sites(make_site_set(fine, kSparseExtent), context);
    const Extent half = {kSparseExtent[0] / 2, kSparseExtent[1] / 2, kSparseExtent[2] / 2};
    CHECK(digest(sites) == digest(make_site_set(coarse, half)));
    CHECK(sites.voxels.voxel_count() == make_site_set(coarse, half).voxels.voxel_count());
  }
}
