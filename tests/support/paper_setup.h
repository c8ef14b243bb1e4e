// What the tests of method shell start from: a shape of voxels as sites, made-up samples, and its shell.
#pragma once

#include <vector>

#include "isoshell/advanced/stages.h"
#include "support/test_context.h"
#include "support/voxel_shapes.h"
#include "voxel/exact_int.h"
#include "voxel/random.h"

namespace isoshell {

struct PaperSetup {
  SiteSet sites;
  SiteSamples samples;
  Shell shell;
};

/// Samples lie anywhere in their voxel, borders included.
inline PaperSetup paper_setup(const voxel_shapes::Named& shape, int32_t band_vox) {
  PaperSetup out;
  out.sites = make_site_set(shape.voxels, shape.extent);
  out.samples.sample = Buffer<SiteSample>(out.sites.voxels.voxel_count());
  for (int64_t i = 0; i < out.samples.sample.size(); ++i) {
    const uint64_t r = random_bits(77, uint64_t(i));
    const auto part = [&](int shift) { return int16_t(int32_t((r >> shift & 0xffff) % 257) - 128); };
    out.samples.sample[i] = {part(0), part(16), part(32), normal8({part(8), part(24), part(40)}), {}, uint32_t(i)};
  }
  TestContext context;
  out.shell = build_shell(out.sites, {band_vox}, context);
  return out;
}

inline std::vector<PointQ8> positions(const SeedSet& seeds) {
  return {seeds.position.data(), seeds.position.data() + seeds.size()};
}

inline SeedSet seeds_at(const std::vector<PointQ8>& positions) {
  SeedSet out;
  out.position = Buffer<PointQ8>(int64_t(positions.size()));
  out.normal = Buffer<Normal8>(int64_t(positions.size()));
  out.home = Buffer<uint32_t>(int64_t(positions.size()));
  for (size_t i = 0; i < positions.size(); ++i) {
    out.position[int64_t(i)] = positions[i];
    out.normal[int64_t(i)] = {0, 0, 127};
    out.home[int64_t(i)] = 0;
  }
  return out;
}

inline voxel_shapes::Named ball_skin(int32_t radius) {
  return voxel_shapes::filled("sphere", {128, 128, 128}, radius + 1, {256, 256, 256},
                              [=](int x, int y, int z) { return voxel_shapes::near_sphere(x, y, z, radius); });
}

}  // namespace isoshell
