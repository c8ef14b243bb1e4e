// Volumes of labels by formula: orderly ones, and ones as ugly as segmentations get.
#pragma once

#include <cmath>
#include <random>

#include "isoshell/regions.h"

namespace isoshell {

inline LabelVolume label_volume(int32_t x, int32_t y, int32_t z) {
  LabelVolume v;
  v.smallest_island_vox = 0;
  v.size_vox = {x, y, z};
  v.labels.assign(size_t(x) * size_t(y) * size_t(z), 0);
  return v;
}

template <class LabelAt>
LabelVolume label_volume(int32_t x, int32_t y, int32_t z, LabelAt label_at) {
  LabelVolume v = label_volume(x, y, z);
  size_t n = 0;
  for (int32_t k = 0; k < z; ++k)
    for (int32_t j = 0; j < y; ++j)
      for (int32_t i = 0; i < x; ++i) v.labels[n++] = label_at(i, j, k);
  return v;
}

/// Grains of a polycrystal that fills a cube: each voxel has the label of the nearest of so many random points.
inline LabelVolume voronoi_grains(int32_t n, int grains, uint32_t seed = 7) {
  std::mt19937 random(seed);
  std::vector<std::array<double, 3>> point(size_t(grains), {0, 0, 0});
  for (auto& p : point)
    for (double& c : p) c = double(random()) / 4294967296.0 * n;
  return label_volume(n, n, n, [&](int x, int y, int z) {
    const double at[3] = {x + 0.5, y + 0.5, z + 0.5};
    int32_t nearest = 0;
    double best = 1e30;
    for (int g = 0; g < grains; ++g) {
      double sum = 0;
      for (size_t c = 0; c < 3; ++c) sum += (at[c] - point[size_t(g)][c]) * (at[c] - point[size_t(g)][c]);
      if (sum < best) best = sum, nearest = g + 1;
    }
    return nearest;
  });
}

/// A folded layer of two to three voxels with background on both sides, parted into so many regions: as ribbons of
/// brains are. The layer is that around a gyroid with a period of 16 voxels.
inline LabelVolume folded_layer(int32_t n, int regions) {
  LabelVolume v = voronoi_grains(n, regions);
  const auto at = [](int32_t i) { return i * (2 * 3.14159265358979 / 16); };
  size_t next = 0;
  for (int32_t k = 0; k < n; ++k)
    for (int32_t j = 0; j < n; ++j)
      for (int32_t i = 0; i < n; ++i, ++next)
        if (std::abs(std::sin(at(i)) * std::cos(at(j)) + std::sin(at(j)) * std::cos(at(k)) +
                     std::sin(at(k)) * std::cos(at(i))) > 0.6)
          v.labels[next] = 0;
  return v;
}

/// One of eight kinds of random volumes, by its number: noise of few and of many labels, checkerboards, lines of one
/// voxel, islands, labels that touch in edges and points only, thin layers, and blobs.
inline LabelVolume random_labels(uint32_t number) {
  std::mt19937 random(number);
  const auto below = [&](uint32_t n) { return int(random() % n); };
  const int32_t x = 3 + below(10), y = 3 + below(10), z = 3 + below(10);
  const int labels = 2 + below(number % 3 == 0 ? 40 : 4);
  switch (number % 8) {
    case 0:
      return label_volume(x, y, z, [&](int, int, int) { return below(uint32_t(labels)); });
    case 1:
      return label_volume(x, y, z, [&](int, int, int) { return below(8) == 0 ? 1 + below(uint32_t(labels)) : 0; });
    case 2:
      return label_volume(x, y, z, [&](int i, int j, int k) { return (i + j + k) % labels; });
    case 3: {  // lines along the axes
      const int at[6] = {below(uint32_t(x)), below(uint32_t(y)), below(uint32_t(z)),
                         below(uint32_t(x)), below(uint32_t(y)), below(uint32_t(z))};
      return label_volume(x, y, z, [&](int i, int j, int k) {
        return i == at[0] && j == at[1] ? 1 : j == at[4] && k == at[2] ? 2 : i == at[3] && k == at[5] ? 3 : 0;
      });
    }
    case 4:
      return label_volume(x, y, z, [&](int i, int j, int k) {
        return i % 3 == 1 && j % 3 == 1 && k % 3 == 1 ? 1 + below(uint32_t(labels)) : below(30) == 0 ? 7 : 9;
      });
    case 5:  // boxes of two voxels that touch in edges and points
      return label_volume(x, y, z, [&](int i, int j, int k) {
        return (i / 2 + j / 2 + k / 2) % 2 == 0 ? 1 + (i / 2 * 7 + j / 2 * 3 + k / 2) % labels : 0;
      });
    case 6:
      return label_volume(x, y, z, [&](int i, int j, int k) { return (i + j / 3 + (k > 2 ? 1 : 0)) % labels; });
    default: {
      std::vector<std::array<double, 4>> ball(size_t(3 + below(6)));
      for (auto& b : ball)
        b = {double(below(uint32_t(x))), double(below(uint32_t(y))), double(below(uint32_t(z))), 1.5 + below(3)};
      return label_volume(x, y, z, [&](int i, int j, int k) {
        int32_t label = 0;
        for (size_t b = 0; b < ball.size(); ++b)
          if (std::hypot(i - ball[b][0], j - ball[b][1], k - ball[b][2]) < ball[b][3]) label = int32_t(b) % labels + 1;
        return label;
      });
    }
  }
}

}  // namespace isoshell
