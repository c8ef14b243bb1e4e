// place_seeds (see stages.h), written once over an executor. Strata of equal area (by the edge lengths, where they
// vary; or of equal count) along the canonical order, one seed at random in each: as even as random seeds get, with a
// prefix sum and a search instead of a sort.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/labels/label_body.h"
#include "voxel/leaf.h"
#include "voxel/random.h"

namespace isoshell {
namespace seeds {

struct FillShare {
  label::ShareOfSeeds share;
  View<int64_t> out;
  ISOSHELL_HD void operator()(int64_t t) const { out[t] = share(t); }
};

/// Seed i: a point at random in the triangle where stratum i's random area falls.
struct PlaceOnSheet {
  View<const PointQ8> position;
  View<const Normal8> vertex_normal;
  View<const TriangleIndices> triangles;
  View<const int64_t> area_before;  ///< exclusive prefix sum of the doubled areas, or shares of the seeds
  int64_t total, count;
  uint64_t seed;
  View<PointQ8> out_position;
  View<Normal8> out_normal;
  View<uint32_t> out_home;

  ISOSHELL_HD void operator()(int64_t i) const {
    const uint64_t r = random_bits(seed, uint64_t(i));
    const int64_t width = total / count, rest = total % count;
    const int64_t target = width * i + rest * i / count + share_of(width, int64_t(r >> 40));
    const TriangleIndices t = triangles[triangle_at(target)];
    // Two 20-bit fractions; folding the parallelogram onto the triangle keeps the density even.
    int64_t u = int64_t(r & 0xfffff), v = int64_t(r >> 20 & 0xfffff);
    constexpr int64_t kOne = 1 << 20;
    if (u + v > kOne) u = kOne - u, v = kOne - v;
    const Vec64 e = difference(position[t.b], position[t.a]), f = difference(position[t.c], position[t.a]);
    const PointQ8 a = position[t.a];
    const PointQ8 p = {a.x + int32_t((e.x * u + f.x * v + kOne / 2) >> 20),
                       a.y + int32_t((e.y * u + f.y * v + kOne / 2) >> 20),
                       a.z + int32_t((e.z * u + f.z * v + kOne / 2) >> 20)};
    const uint32_t home = 2 * u > kOne ? t.b : (2 * v > kOne ? t.c : t.a);
    out_position[i] = p;
    out_normal[i] = vertex_normal[home];
    out_home[i] = home;
  }

  /// width * fraction / 2^24, without a product beyond 63 bits.
  ISOSHELL_HD static int64_t share_of(int64_t width, int64_t fraction_24) {
    return (width >> 24) * fraction_24 + ((width & 0xffffff) * fraction_24 >> 24);
  }

  /// The triangle whose share of the running area holds the target.
  ISOSHELL_HD int64_t triangle_at(int64_t target) const {
    int64_t lo = 0, hi = triangles.size;
    while (hi - lo > 1) {
      const int64_t mid = lo + (hi - lo) / 2;
      if (area_before[mid] <= target)
        lo = mid;
      else
        hi = mid;
    }
    return lo;
  }
};

}  // namespace seeds

template <class Exec>
SeedSet place_seeds_body(Exec& exec, const SurfaceMesh& surface, const SeedOptions& options) {
  const int64_t triangles = surface.triangles.size();
  Buffer<int64_t> area_before = exec.template make<int64_t>(triangles);
  exec.for_each(
      "areas", triangles,
      seeds::FillShare{{{surface.position.view(), surface.triangles.view()}, lengths_of(surface)}, area_before.view()});
  const int64_t total = exec.exclusive_scan(area_before.view());
  SeedSet out;
  out.position = exec.template make<PointQ8>(options.count);
  out.normal = exec.template make<Normal8>(options.count);
  out.home = exec.template make<uint32_t>(options.count);
  exec.for_each(
      "place seeds", options.count,
      seeds::PlaceOnSheet{surface.position.view(), surface.normal.view(), surface.triangles.view(), area_before.view(),
                          total, options.count, options.seed, out.position.view(), out.normal.view(), out.home.view()});
  return out;
}

namespace seeds {

/// Seed i: the sample of one site at random in stratum i.
struct PlaceOnSites {
  VoxelSetView sites;
  View<const SiteSample> samples;
  int64_t count;
  uint64_t seed;
  View<PointQ8> out_position;
  View<Normal8> out_normal;
  View<uint32_t> out_home;

  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t total = sites.first[sites.leaf_key.size], width = total / count, rest = total % count;
    const int64_t lo = width * i + rest * i / count, hi = width * (i + 1) + rest * (i + 1) / count;
    const int64_t site = lo + int64_t(random_bits(seed, uint64_t(i)) % uint64_t(hi - lo));
    const PointQ8 centre = voxel_centre(voxel_of_index(sites, site));
    const SiteSample& s = samples[site];
    out_position[i] = {centre.x + s.dx, centre.y + s.dy, centre.z + s.dz};
    out_normal[i] = s.normal;
    out_home[i] = uint32_t(site);
  }
};

}  // namespace seeds

template <class Exec>
SeedSet place_seeds_body(Exec& exec, const SiteSet& sites, const SiteSamples& samples, const SeedOptions& options) {
  SeedSet out;
  out.position = exec.template make<PointQ8>(options.count);
  out.normal = exec.template make<Normal8>(options.count);
  out.home = exec.template make<uint32_t>(options.count);
  exec.for_each("place seeds", options.count,
                seeds::PlaceOnSites{sites.voxels.view(), samples.sample.view(), options.count, options.seed,
                                    out.position.view(), out.normal.view(), out.home.view()});
  return out;
}

}  // namespace isoshell
