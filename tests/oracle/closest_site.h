// Oracle of the shell: every site offers itself to every voxel of its ball; the smallest (squared distance, id) stays.
#pragma once

#include <algorithm>
#include <vector>

#include "support/voxel_sites.h"

namespace isoshell::oracle {

/// The answer for every voxel of a box around the sites.
struct ClosestSites {
  static constexpr uint64_t kNothing = ~uint64_t(0);
  Voxel lo{}, hi{};            ///< inclusive
  std::vector<uint64_t> best;  ///< x-major; squared distance << 32 | site id

  uint64_t& at(Voxel v) {
    return best[(size_t(v.x - lo.x) * size_t(hi.y - lo.y + 1) + size_t(v.y - lo.y)) * size_t(hi.z - lo.z + 1) +
                size_t(v.z - lo.z)];
  }
};

/// Voxels outside 0..extent do not exist. `sites` by id.
inline ClosestSites closest_sites(const std::vector<Voxel>& sites, int32_t band_vox, Extent extent) {
  ClosestSites out;
  out.lo = out.hi = sites.front();
  for (Voxel s : sites) {
    out.lo = {std::min(out.lo.x, s.x), std::min(out.lo.y, s.y), std::min(out.lo.z, s.z)};
    out.hi = {std::max(out.hi.x, s.x), std::max(out.hi.y, s.y), std::max(out.hi.z, s.z)};
  }
  const int32_t d = band_vox;
  out.lo = {std::max(out.lo.x - d, 0), std::max(out.lo.y - d, 0), std::max(out.lo.z - d, 0)};
  out.hi = {std::min(out.hi.x + d, extent[0] - 1), std::min(out.hi.y + d, extent[1] - 1),
            std::min(out.hi.z + d, extent[2] - 1)};
  out.best.assign(size_t(out.hi.x - out.lo.x + 1) * size_t(out.hi.y - out.lo.y + 1) * size_t(out.hi.z - out.lo.z + 1),
                  ClosestSites::kNothing);
  for (size_t id = 0; id < sites.size(); ++id) {
    const Voxel s = sites[id];
    for (int32_t x = std::max(s.x - d, out.lo.x); x <= std::min(s.x + d, out.hi.x); ++x)
      for (int32_t y = std::max(s.y - d, out.lo.y); y <= std::min(s.y + d, out.hi.y); ++y)
        for (int32_t z = std::max(s.z - d, out.lo.z); z <= std::min(s.z + d, out.hi.z); ++z) {
          const int32_t sq = (x - s.x) * (x - s.x) + (y - s.y) * (y - s.y) + (z - s.z) * (z - s.z);
          if (sq > d * d) continue;
          uint64_t& best = out.at({x, y, z});
          best = std::min(best, uint64_t(sq) << 32 | id);
        }
  }
  return out;
}

}  // namespace isoshell::oracle
