// The solid of build_sheet by brute force on a dense lattice.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell::oracle {

/// One value per voxel of a small lattice.
struct Dense {
  std::array<int32_t, 3> extent;
  std::vector<char> value;

  explicit Dense(std::array<int32_t, 3> size)
      : extent(size), value(size_t(size[0]) * size_t(size[1]) * size_t(size[2]), 0) {}
  bool holds(Voxel v) const {
    return v.x >= 0 && v.y >= 0 && v.z >= 0 && v.x < extent[0] && v.y < extent[1] && v.z < extent[2];
  }
  size_t at(Voxel v) const { return (size_t(v.x) * size_t(extent[1]) + size_t(v.y)) * size_t(extent[2]) + size_t(v.z); }
  char get(Voxel v, char beyond) const { return holds(v) ? value[at(v)] : beyond; }
  template <class Visit>
  void for_each(Visit visit) const {
    for (int32_t x = 0; x < extent[0]; ++x)
      for (int32_t y = 0; y < extent[1]; ++y)
        for (int32_t z = 0; z < extent[2]; ++z) visit(Voxel{x, y, z});
  }
};

/// Voxels within r of a voxel that is set.
inline Dense thickened(const Dense& set, int32_t r) {
  Dense out(set.extent);
  set.for_each([&](Voxel v) {
    if (!set.get(v, 0)) return;
    for (int32_t x = -r; x <= r; ++x)
      for (int32_t y = -r; y <= r; ++y)
        for (int32_t z = -r; z <= r; ++z) {
          const Voxel n = {v.x + x, v.y + y, v.z + z};
          if (x * x + y * y + z * z <= r * r && out.holds(n)) out.value[out.at(n)] = 1;
        }
  });
  return out;
}

using Voxels = std::vector<Voxel>;

/// Voxels off `blocked` that face neighbours off `blocked` join to the border or a hollow.
inline Dense outside_of(const Dense& blocked, const Voxels& hollows = {}) {
  Dense out(blocked.extent);
  std::vector<Voxel> front;
  const auto enter = [&](Voxel v) {
    if (!out.holds(v) || out.value[out.at(v)] || blocked.value[out.at(v)]) return;
    out.value[out.at(v)] = 1;
    front.push_back(v);
  };
  out.for_each([&](Voxel v) {
    const bool border = !out.holds({v.x - 1, v.y - 1, v.z - 1}) || !out.holds({v.x + 1, v.y + 1, v.z + 1});
    if (border) enter(v);
  });
  for (const Voxel v : hollows) enter(v);
  while (!front.empty()) {
    const Voxel v = front.back();
    front.pop_back();
    for (const int32_t d : {-1, 1}) {
      enter({v.x + d, v.y, v.z});
      enter({v.x, v.y + d, v.z});
      enter({v.x, v.y, v.z + d});
    }
  }
  return out;
}

inline Dense closed(const Dense& sites, int32_t r, const Voxels& hollows = {}) {
  Dense out = thickened(outside_of(thickened(sites, r), hollows), r);
  for (char& v : out.value) v = !v;
  return out;
}

inline Dense filled(const Dense& solid, const Voxels& hollows = {}) {
  Dense out = outside_of(solid, hollows);
  for (char& v : out.value) v = !v;
  return out;
}

/// One synchronous round; see find_additions for what is added. Returns whether anything was.
inline bool repair_once(Dense& solid) {
  std::vector<Voxel> add;
  const auto on = [&](Voxel v) { return solid.get(v, 0) != 0; };
  const auto square = [&](Voxel a, Voxel b, Voxel c, Voxel d) {  // b and c beside a along the first and the second axis
    if (on(a) && on(d) && !on(b) && !on(c)) add.push_back(c);
    if (!on(a) && !on(d) && on(b) && on(c)) add.push_back(a);
  };
  solid.for_each([&](Voxel v) {
    const Voxel x = {v.x + 1, v.y, v.z}, y = {v.x, v.y + 1, v.z}, z = {v.x, v.y, v.z + 1};
    square(v, x, y, {v.x + 1, v.y + 1, v.z});
    square(v, x, z, {v.x + 1, v.y, v.z + 1});
    square(v, y, z, {v.x, v.y + 1, v.z + 1});
    int count = 0;
    for (int o = 0; o < 8; ++o) count += on({v.x + (o >> 2), v.y + (o >> 1 & 1), v.z + (o & 1)});
    for (int o = 0; o < 4; ++o) {
      const Voxel p = {v.x, v.y + (o >> 1), v.z + (o & 1)}, q = {v.x + 1, v.y + 1 - (o >> 1), v.z + 1 - (o & 1)};
      if (count == 2 && on(p) && on(q)) {
        add.push_back({q.x, p.y, p.z});
        add.push_back({q.x, q.y, p.z});
      }
      if (count == 6 && !on(p) && !on(q)) add.push_back(p);
    }
  });
  for (const Voxel v : add) solid.value[solid.at(v)] = 1;
  return !add.empty();
}

}  // namespace isoshell::oracle
