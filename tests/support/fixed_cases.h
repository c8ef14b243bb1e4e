// Surfaces with fixed seeds on their borders and free ones inside, few and many: what stages that know patches are
// tested on.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "support/cut_surfaces.h"

namespace isoshell {

struct FixedCase {
  std::string name;
  SurfaceMesh surface;
  SeedSet seeds;
};

/// A seed at one border vertex of each `apart`.
inline auto every_steps(int32_t apart, int32_t step_q8) {
  return [=](PointQ8 p) { return (p.x + p.y + p.z - 30000) / step_q8 % apart == 0; };
}

/// A free seed at the first vertex of each patch.
inline SeedSet one_seed_a_patch(const SurfaceMesh& surface) {
  std::vector<uint32_t> home;
  for (int64_t v = 0; v < surface.vertex_count(); ++v)
    if (v == 0 || surface.patch[v] != surface.patch[v - 1]) home.push_back(uint32_t(v));
  const auto count = int64_t(home.size());
  SeedSet seeds{Buffer<PointQ8>(count), Buffer<Normal8>(count), to_buffer(home), {}};
  for (int64_t i = 0; i < count; ++i) {
    seeds.position[i] = surface.position[seeds.home[i]];
    seeds.normal[i] = surface.normal[seeds.home[i]];
  }
  return seeds;
}

inline std::vector<FixedCase> fixed_cases(Context& context) {
  std::vector<FixedCase> cases;
  constexpr int32_t kStep = 150, kWaveStep = 90;
  const auto box = [&] { return surface_of(cut_box({24, 20, 16}, kStep), context); };
  const auto add = [&](const std::string& name, SurfaceMesh&& surface, int32_t apart, int64_t free) {
    SeedSet seeds = with_free_seeds(surface, fixed_on_borders(surface, every_steps(apart, kStep)), free);
    cases.push_back({name, std::move(surface), std::move(seeds)});
  };
  add("box", box(), 4, 200);
  add("box with few free seeds", box(), 4, 6);
  add("box with fixed seeds only", box(), 3, 0);
  add("box full of seeds", box(), 1, 1200);

  SurfaceMesh flipped = box();
  for (int64_t v = 0; v < flipped.vertex_count(); v += 49) {
    Normal8& n = flipped.normal[v];
    n = {int8_t(-n.x), int8_t(-n.y), int8_t(-n.z)};
  }
  add("box with vertices that all seeds around face away from", std::move(flipped), 4, 150);

  SurfaceMesh bare = box();
  SeedSet lonely = one_seed_a_patch(bare);
  cases.push_back({"box with one seed a patch", std::move(bare), std::move(lonely)});

  // Holes of a single square, too: of their four vertices at least one is a seed.
  SurfaceMesh holes = surface_of(patch_with_holes(60, 50, kWaveStep), context);
  const auto is_seed = [](PointQ8 p) { return (p.x + p.y - 20000) / kWaveStep % 3 == 0; };
  SeedSet seeds = with_free_seeds(holes, fixed_on_borders(holes, is_seed), 150);
  cases.push_back({"patch with holes", std::move(holes), std::move(seeds)});
  return cases;
}

}  // namespace isoshell
