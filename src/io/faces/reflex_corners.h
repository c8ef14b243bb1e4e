// The corners of a polygon that may lie in ears, found by where they are.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace isoshell {

struct PlanePosition {
  double u, v;
};

/// Twice the area of a triangle, positive where it turns left. Each rounded operation keeps the order of `r`, so what
/// holds for the corners of a box holds for all points in it.
inline double doubled_area(PlanePosition p, PlanePosition q, PlanePosition r) {
  return (q.u - p.u) * (r.v - p.v) - (q.v - p.v) * (r.u - p.u);
}

/// A tree of boxes, halved along their longer sides down to few corners, over an array.
class ReflexCorners {
 public:
  /// Of `corners`, all of them present. Cost: O(n log n).
  void build(std::vector<uint32_t> corners, const std::vector<PlanePosition>& at);

  /// If it was among them.
  void remove(uint32_t corner);

  /// Whether `is_in_the_way(corner)` holds for one that is present and in the triangle, which turns left, or on its
  /// sides. Cost: O(sqrt n) boxes for each side, and the corners that are in it, up to the first.
  template <class Test>
  bool any_in(const std::array<PlanePosition, 3>& triangle, const Test& is_in_the_way) const {
    const auto [low, high] = std::minmax({triangle[0].u, triangle[1].u, triangle[2].u});
    return any_in(1, {triangle, low, high}, is_in_the_way);
  }

 private:
  static constexpr uint32_t kFewCorners = 8, kNowhere = 0xffffffffu;

  struct Node {
    PlanePosition low, high;
    uint32_t first = 0, end = 0;  ///< in corner_
    uint32_t present = 0;
  };

  struct Ear {
    std::array<PlanePosition, 3> at;
    double lowest_u, highest_u;  ///< keeps points out that rounding lets be on all of its sides
  };

  /// Whether the box is beside the ear, or on the right of a side.
  static bool is_apart(const Node& n, const Ear& ear) {
    if (n.high.u < ear.lowest_u || n.low.u > ear.highest_u) return true;
    for (std::size_t i = 0; i < 3; ++i) {
      const PlanePosition p = ear.at[i], q = ear.at[(i + 1) % 3];
      const PlanePosition leftmost{q.v > p.v ? n.low.u : n.high.u, q.u > p.u ? n.high.v : n.low.v};
      if (doubled_area(p, q, leftmost) < 0) return true;
    }
    return false;
  }

  template <class Test>
  bool any_in(uint32_t node, const Ear& ear, const Test& is_in_the_way) const {
    const Node& n = node_[node];
    if (n.present == 0 || is_apart(n, ear)) return false;
    if (2 * node < node_.size())
      return any_in(2 * node, ear, is_in_the_way) || any_in(2 * node + 1, ear, is_in_the_way);
    for (uint32_t i = n.first; i < n.end; ++i) {
      const uint32_t corner = corner_[i];
      if (leaf_of_[corner] == kNowhere) continue;
      const PlanePosition r = (*at_)[corner];
      const auto& [a, b, c] = ear.at;
      if (r.u >= ear.lowest_u && r.u <= ear.highest_u && doubled_area(a, b, r) >= 0 && doubled_area(b, c, r) >= 0 &&
          doubled_area(c, a, r) >= 0 && is_in_the_way(corner))
        return true;
    }
    return false;
  }

  void build_node(uint32_t node, uint32_t first, uint32_t end);

  const std::vector<PlanePosition>* at_ = nullptr;
  std::vector<uint32_t> corner_;
  std::vector<uint32_t> leaf_of_;  ///< by corner; kNowhere: not among them, or removed
  std::vector<Node> node_;         ///< from 1 on; those below node k are 2 k and 2 k + 1
};

}  // namespace isoshell
