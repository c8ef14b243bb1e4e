// Nearest points: a balanced tree of boxes over points, without pointers.
#pragma once

#include <tbb/parallel_invoke.h>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "geometry/world_vector.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

inline double coordinate(const WorldPoint& p, int axis) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; }

class PointTree {
 public:
  /// Squared distance and index, nearest first; equal distances by index.
  using Near = std::pair<double, uint32_t>;

  /// The points must outlive the tree.
  explicit PointTree(const std::vector<WorldPoint>& points) : points_(points), order_(points.size()) {
    for (size_t i = 0; i < order_.size(); ++i) order_[i] = uint32_t(i);
    sort(0, order_.size(), 0);
  }

  /// The `count` points nearest to p, itself among them when it is one.
  void nearest(const WorldPoint& p, size_t count, std::vector<Near>& found) const {
    found.clear();
    search(p, count, 0, order_.size(), 0, found);
    std::sort_heap(found.begin(), found.end());
  }

 private:
  static constexpr size_t kLeaf = 8;

  void sort(size_t begin, size_t end, int axis) {
    if (end - begin <= kLeaf) return;
    const size_t middle = begin + (end - begin) / 2;
    std::nth_element(order_.begin() + int64_t(begin), order_.begin() + int64_t(middle), order_.begin() + int64_t(end),
                     [&](uint32_t a, uint32_t b) {
                       const double x = coordinate(points_[a], axis), y = coordinate(points_[b], axis);
                       return x != y ? x < y : a < b;
                     });
    const int next = (axis + 1) % 3;
    if (end - begin < 4096) {
      sort(begin, middle, next);
      sort(middle + 1, end, next);
    } else {
      tbb::parallel_invoke([&] { sort(begin, middle, next); }, [&] { sort(middle + 1, end, next); });
    }
  }

  void search(const WorldPoint& p, size_t count, size_t begin, size_t end, int axis, std::vector<Near>& found) const {
    if (end - begin <= kLeaf) {
      for (size_t i = begin; i < end; ++i) offer(p, order_[i], count, found);
      return;
    }
    const size_t middle = begin + (end - begin) / 2;
    const double beyond = coordinate(p, axis) - coordinate(points_[order_[middle]], axis);
    const int next = (axis + 1) % 3;
    offer(p, order_[middle], count, found);
    if (beyond < 0)
      search(p, count, begin, middle, next, found);
    else
      search(p, count, middle + 1, end, next, found);
    if (found.size() == count && beyond * beyond > found.front().first) return;
    if (beyond < 0)
      search(p, count, middle + 1, end, next, found);
    else
      search(p, count, begin, middle, next, found);
  }

  void offer(const WorldPoint& p, uint32_t i, size_t count, std::vector<Near>& found) const {
    const Near near{distance_sq(p, points_[i]), i};
    if (found.size() == count) {
      if (!(near < found.front())) return;
      std::pop_heap(found.begin(), found.end());
      found.pop_back();
    }
    found.push_back(near);
    std::push_heap(found.begin(), found.end());
  }

  const std::vector<WorldPoint>& points_;
  std::vector<uint32_t> order_;
};

}  // namespace isoshell
