// Oracles of method shell: nearest seeds, cell sums and the flood, by looking at everything.
#pragma once

#include <algorithm>
#include <vector>

#include "isoshell/advanced/shell.h"
#include "support/voxel_sites.h"
#include "voxel/exact_int.h"

namespace isoshell::oracle {

/// Per active voxel the seed of the smallest (squared distance from the voxel's centre, id).
inline std::vector<uint32_t> nearest_seeds(const VoxelSet& voxels, const std::vector<PointQ8>& seeds) {
  std::vector<uint32_t> out;
  for (Voxel v : voxels_of(voxels)) {
    int64_t least = INT64_MAX;
    uint32_t best = kNone;
    for (size_t s = 0; s < seeds.size(); ++s) {
      const int64_t d = distance_sq_q16(voxel_centre(v), seeds[s]);
      if (d < least) least = d, best = uint32_t(s);
    }
    out.push_back(best);
  }
  return out;
}

/// Count, moment about the seed and squared distances (q16) of every cell.
struct Cell {
  int64_t count = 0;
  Vec64 moment{0, 0, 0};
  int64_t energy_q16 = 0;
};
inline std::vector<Cell> cells(const VoxelSet& voxels, const std::vector<PointQ8>& seeds) {
  const std::vector<uint32_t> label = nearest_seeds(voxels, seeds);
  const std::vector<Voxel> all = voxels_of(voxels);
  std::vector<Cell> out(seeds.size());
  for (size_t i = 0; i < all.size(); ++i) {
    Cell& cell = out[label[i]];
    const Vec64 d = difference(voxel_centre(all[i]), seeds[label[i]]);
    ++cell.count;
    cell.moment = cell.moment + d;
    cell.energy_q16 += dot(d, d);
  }
  return out;
}

/// The flood as its definition says it: every round looks at every voxel, from one array into another.
inline std::vector<uint32_t> flood(const VoxelSet& voxels, const std::vector<PointQ8>& seeds) {
  const std::vector<Voxel> all = voxels_of(voxels);
  const VoxelSetView view = voxels.view();
  const auto closer = [&](size_t voxel, uint32_t a, uint32_t b) {
    if (b == kNone) return true;
    const int64_t da = distance_sq_q16(voxel_centre(all[voxel]), seeds[a]);
    const int64_t db = distance_sq_q16(voxel_centre(all[voxel]), seeds[b]);
    return da != db ? da < db : a < b;
  };
  std::vector<uint32_t> label(all.size(), kNone);
  for (uint32_t s = 0; s < seeds.size(); ++s) {
    int64_t start = find_voxel(view, voxel_of(seeds[s]));
    if (start < 0)
      for (size_t i = 0; i < all.size(); ++i)
        if (start < 0 || distance_sq_q16(voxel_centre(all[i]), seeds[s]) <
                             distance_sq_q16(voxel_centre(all[size_t(start)]), seeds[s]))
          start = int64_t(i);
    if (start >= 0 && closer(size_t(start), s, label[size_t(start)])) label[size_t(start)] = s;
  }
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<uint32_t> next = label;
    for (size_t i = 0; i < all.size(); ++i) {
      if (label[i] != kNone) continue;
      for (int n = 0; n < 27; ++n) {
        const int64_t other = find_voxel(view, {all[i].x + n / 9 - 1, all[i].y + n / 3 % 3 - 1, all[i].z + n % 3 - 1});
        if (other < 0 || label[size_t(other)] == kNone || !closer(i, label[size_t(other)], next[i])) continue;
        next[i] = label[size_t(other)];
        changed = true;
      }
    }
    label = next;
  }
  return label;
}

}  // namespace isoshell::oracle
