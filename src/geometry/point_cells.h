// Points by the cells of a grid.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/box.h"

namespace isoshell {

/// Cost: a sort of the points; a look at a box is a search for each cell that it meets.
class PointCells {
 public:
  PointCells(const std::vector<WorldPoint>& points, double width) : width_(width) {
    for (size_t i = 0; i < points.size(); ++i) order_.push_back({key_of(cell_of(points[i])), i});
    std::sort(order_.begin(), order_.end());
  }

  /// visit(index) of all points in the box, and of some beside it.
  template <class Visit>
  void for_each_in(const WorldBox& box, Visit visit) const {
    const Cell from = cell_of(box.min), to = cell_of(box.max);
    for (int64_t x = from[0]; x <= to[0]; ++x)
      for (int64_t y = from[1]; y <= to[1]; ++y)
        for (int64_t z = from[2]; z <= to[2]; ++z) {
          const uint64_t key = key_of({x, y, z});
          auto at = std::lower_bound(order_.begin(), order_.end(), std::pair<uint64_t, size_t>{key, 0});
          for (; at != order_.end() && at->first == key; ++at) visit(at->second);
        }
  }

 private:
  using Cell = std::array<int64_t, 3>;
  Cell cell_of(const WorldPoint& p) const {
    return {int64_t(std::floor(p.x / width_)), int64_t(std::floor(p.y / width_)), int64_t(std::floor(p.z / width_))};
  }
  static uint64_t key_of(const Cell& c) {  // cells that share a key only cost time
    return uint64_t(c[0]) * 0x9e3779b97f4a7c15ull ^ uint64_t(c[1]) * 0xc2b2ae3d27d4eb4full ^
           uint64_t(c[2]) * 0x165667b19e3779f9ull;
  }

  double width_;
  std::vector<std::pair<uint64_t, size_t>> order_;  ///< key and index, ascending
};

}  // namespace isoshell
