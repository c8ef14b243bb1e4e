// Sets of voxels made by code, placed where leaves (8), lower nodes (128) and upper nodes (4096) meet.
#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "support/voxel_sites.h"
#include "voxel/random.h"

namespace isoshell::voxel_shapes {

struct Named {
  std::string name;
  std::vector<Voxel> voxels;
  Extent extent;
};

/// Voxels v with inside(v - centre) within a cube of half side `half`, as far as they lie in the lattice.
template <class Inside>
Named filled(std::string name, Voxel centre, int32_t half, Extent extent, Inside inside) {
  Named out{std::move(name), {}, extent};
  for (int32_t x = -half; x <= half; ++x)
    for (int32_t y = -half; y <= half; ++y)
      for (int32_t z = -half; z <= half; ++z) {
        const Voxel v = {centre.x + x, centre.y + y, centre.z + z};
        if (v.x < 0 || v.y < 0 || v.z < 0 || v.x >= extent[0] || v.y >= extent[1] || v.z >= extent[2]) continue;
        if (inside(x, y, z)) out.voxels.push_back(v);
      }
  return out;
}

inline bool near_sphere(double x, double y, double z, double radius) {
  return std::abs(std::sqrt(x * x + y * y + z * z) - radius) <= 0.7;
}
inline bool near_torus(double x, double y, double z, double major, double minor) {
  const double q = std::sqrt(x * x + y * y) - major;
  return std::abs(std::sqrt(q * q + z * z) - minor) <= 0.7;
}

/// One of each kind; `r` is about half the size of a shape in voxels.
inline std::vector<Named> all(int32_t r) {
  const double R = r;
  const Extent small = {512, 512, 512}, wide = {8192, 4352, 4224};
  std::vector<Named> out;
  out.push_back(filled("sphere around a lower node's corner", {128, 256, 128}, r + 1, small,
                       [&](int x, int y, int z) { return near_sphere(x, y, z, R); }));
  out.push_back(filled("torus around an upper node's corner", {4096, 4096, 4096}, r + 1, wide,
                       [&](int x, int y, int z) { return near_torus(x, y, z, R * .65, R * .33); }));
  out.push_back(
      filled("two parallel walls two voxels apart, askew", {4096, 130, 250}, r, wide, [&](int x, int y, int z) {
        const int q = x + 2 * y - 3 * z;
        return std::abs(q) <= 1 || std::abs(q - 14) <= 1;
      }));
  out.push_back(filled("plane on a node border, full of ties", {255, 128, 384}, r, small,
                       [&](int x, int y, int) { return x == 0 && (y & 1) == 0; }));
  out.push_back(filled("checkerboard of single voxels eight apart", {128, 126, 131}, r, small,
                       [&](int x, int y, int z) { return ((x | y | z) & 3) == 0 && ((x + y + z) & 7) == 0; }));
  out.push_back(filled("scattered voxels", {124, 4093, 125}, r, wide, [&](int x, int y, int z) {
    return random_bits(5, uint64_t((x * 1024 + y) * 1024 + z + (int64_t(1) << 40))) % 997 == 0;
  }));
  out.push_back(filled("solid ball in the lattice's corner", {r / 2, 500, r / 3}, r / 2, small,
                       [&](int x, int y, int z) { return 4 * (x * x + y * y + z * z) <= r * r; }));
  out.push_back(filled("curve across two upper nodes", {4096, 4095, 127}, r, wide, [&](int x, int y, int z) {
    return y == int(std::lround(R * .4 * x / R)) && z == int(std::lround(R * .5 * (double(x) * x / (R * R))));
  }));
  return out;
}

}  // namespace isoshell::voxel_shapes
