// Which points are near to others.
#pragma once

#include <algorithm>
#include <vector>

#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// The cells of a coarse grid that hold points, or are beside one that does: all that is within `reach_q8` of a point,
/// and nothing that is four times as far.
class NearPoints {
 public:
  NearPoints(const std::vector<PointQ8>& points, double reach_q8) : width_(std::max(1, int32_t(reach_q8))) {
    for (const PointQ8 p : points)
      for (int64_t x = -1; x <= 1; ++x)
        for (int64_t y = -1; y <= 1; ++y)
          for (int64_t z = -1; z <= 1; ++z) cells_.push_back(key(p.x / width_ + x, p.y / width_ + y, p.z / width_ + z));
    std::sort(cells_.begin(), cells_.end());
    cells_.erase(std::unique(cells_.begin(), cells_.end()), cells_.end());
  }
  bool holds(PointQ8 p) const {
    return std::binary_search(cells_.begin(), cells_.end(), key(p.x / width_, p.y / width_, p.z / width_));
  }

 private:
  static uint64_t key(int64_t x, int64_t y, int64_t z) {
    return uint64_t(x + 1) << 42 | uint64_t(y + 1) << 21 | uint64_t(z + 1);
  }
  int32_t width_;
  std::vector<uint64_t> cells_;  ///< ascending
};

}  // namespace isoshell
