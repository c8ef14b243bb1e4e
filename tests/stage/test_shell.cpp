// build_shell against its oracle.
#include <cstdlib>

#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "oracle/closest_site.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/test_context.h"
#include "support/voxel_shapes.h"
#include "voxel/closest.h"

using namespace isoshell;

namespace {

Shell shell_of(const SiteSet& sites, int32_t band_vox, int threads = 0) {
  TestContext context;
  context.threads = threads;
  ShellOptions options;
  options.band_vox = band_vox;
  return build_shell(sites, options, context);
}

/// Voxels compared and voxels that differ (in activity, distance or closest site) between build_shell and the oracle.
struct Comparison {
  int64_t active = 0, looked_at = 0, mismatches = 0;
};

Comparison compare(const std::vector<Voxel>& voxels, int32_t band_vox, Extent extent) {
  const SiteSet sites = make_site_set(voxels, extent);
  const Shell shell = shell_of(sites, band_vox);
  oracle::ClosestSites expected = oracle::closest_sites(voxels_of(sites.voxels), band_vox, extent);
  Comparison result;
  result.looked_at = int64_t(expected.best.size());
  for (uint64_t e : expected.best) result.active += e != oracle::ClosestSites::kNothing;
  const std::vector<Voxel> active = voxels_of(shell.voxels);
  result.mismatches = std::abs(result.active - int64_t(active.size()));
  for (size_t i = 0; i < active.size(); ++i) {
    const Voxel v = active[i];
    const bool inside = v.x >= expected.lo.x && v.y >= expected.lo.y && v.z >= expected.lo.z && v.x <= expected.hi.x &&
                        v.y <= expected.hi.y && v.z <= expected.hi.z;
    const uint64_t got = uint64_t(shell.distance_sq_vox[int64_t(i)]) << 32 | shell.closest_site[int64_t(i)];
    result.mismatches += !inside || expected.at(v) != got;
  }
  return result;
}

Comparison compare_all(const std::vector<voxel_shapes::Named>& shapes, std::initializer_list<int32_t> bands) {
  Comparison total;
  for (const auto& shape : shapes)
    for (const int32_t band_vox : bands) {
      const Comparison c = compare(shape.voxels, band_vox, shape.extent);
      INFO(shape.name << ", d = " << band_vox << ", " << c.active << " active voxels");
      CHECK(c.mismatches == 0);
      CHECK(c.active > 0);
      total.active += c.active;
      total.looked_at += c.looked_at;
      total.mismatches += c.mismatches;
    }
  return total;
}

}  // namespace

TEST_CASE("closest: places among the neighbours follow the leaf keys, whatever node borders they cross",
          "[shell][unit]") {
  for (const int32_t x : {3, 13, 15, 16, 30, 509, 511, 512, 514})
    for (const int32_t y : {7, 15, 16, 511, 512, 1022})
      for (const int32_t z : {5, 14, 17, 510, 513})
        for (int reach = 1; reach <= 3; ++reach) {
          Neighbourhood around;
          around.span = 2 * reach + 1;
          order_neighbours(around, {x - reach, y - reach, z - reach});
          std::vector<uint64_t> key_at_place(size_t(around.span * around.span * around.span));
          for (int i = 0; i < around.span; ++i)
            for (int j = 0; j < around.span; ++j)
              for (int k = 0; k < around.span; ++k)
                key_at_place.at(around.place[around.at(i, j, k)]) =
                    leaf_key({x - reach + i, y - reach + j, z - reach + k});
          CHECK(std::is_sorted(key_at_place.begin(), key_at_place.end()));
          CHECK(std::adjacent_find(key_at_place.begin(), key_at_place.end()) == key_at_place.end());
        }
}

TEST_CASE("shell: each active voxel stores its exact closest site, and exactly the voxels within d are active",
          "[shell][stage]") {
  compare_all(voxel_shapes::all(24), {1, 2, 3, 6, 9, 15, 20});
}

TEST_CASE("shell: exact on tens of millions of voxels", "[.slow][shell][stage]") {
  const Comparison total = compare_all(voxel_shapes::all(100), {1, 2, 3, 5, 6, 8, 9, 15, 16, 17, 20});
  WARN(total.active << " active voxels, " << total.looked_at << " voxels looked at, " << total.mismatches
                    << " mismatches");
}

TEST_CASE("shell: the same for any number of threads and any order of the input", "[shell][stage]") {
  for (auto& shape : voxel_shapes::all(40)) {
    const SiteSet sites = make_site_set(shape.voxels, shape.extent);
    std::reverse(shape.voxels.begin(), shape.voxels.end());
    const SiteSet reversed = make_site_set(shape.voxels, shape.extent);
    for (const int32_t band_vox : {2, 9}) {
      const uint64_t one = digest(shell_of(sites, band_vox, 1));
      CHECK(one == digest(shell_of(sites, band_vox, 2)));
      CHECK(one == digest(shell_of(reversed, band_vox)));
    }
  }
}

TEST_CASE("shell: without sites it is empty", "[shell][stage]") {
  const Shell shell = shell_of(make_site_set({}, {64, 64, 64}), 3);
  CHECK(shell.voxels.voxel_count() == 0);
  CHECK(shell.closest_site.empty());
}

TEST_CASE("shell: a band outside 1 to kMaxBandVox is a usage error that names the limit", "[shell][stage]") {
  const SiteSet sites = make_site_set({{40, 40, 40}}, {128, 128, 128});
  for (const int32_t band_vox : {-1, 0, kMaxBandVox + 1}) {
    CHECK(contains(message_of(ErrorCode::usage, [&] { shell_of(sites, band_vox); }), "1 to 20"));
  }
}
