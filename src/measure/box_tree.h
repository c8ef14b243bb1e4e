// Which boxes on the lattice meet a box.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/box.h"

namespace isoshell {

/// A balanced tree of boxes: each node halves its boxes by their middles, along the axis on which it is longest. Node n
/// has the nodes 2 n + 1 and 2 n + 2 below it.
class BoxTree {
 public:
  /// Cost: n log n for n boxes, in parallel.
  explicit BoxTree(const std::vector<BoxQ8>& boxes) : BoxTree(boxes.size(), [&](uint32_t i) { return boxes[i]; }) {}
  /// Of so many boxes, box_of(i) each, which need not all be held at once.
  template <class BoxOf>
  BoxTree(size_t count, const BoxOf& box_of) {
    list_.reserve(count);
    for (uint32_t i = 0; i < count; ++i) list_.push_back({box_of(i), i});
    arrange_all();
  }

  /// Calls visit(i) for each box i that meets this one, in any order, while that returns true. Result: whether all did.
  template <class Visit>
  bool for_all_meeting(const BoxQ8& box, Visit visit) const {
    return list_.empty() || for_all_below({0, 0, list_.size()}, box, visit);
  }

  /// Calls visit(i, j) for every two boxes that meet, once in all groups together: neighbours are looked for by a few
  /// boxes at a time, which are near one another. In any order.
  size_t groups() const { return (list_.size() + kGroup - 1) / kGroup; }
  template <class Visit>
  void for_pairs_of(size_t group, Visit visit) const {
    const size_t begin = group * kGroup, end = std::min(list_.size(), begin + kGroup);
    BoxQ8 around = list_[begin].box;
    for (size_t i = begin + 1; i < end; ++i) around = joined(around, list_[i].box);
    const auto look = [&](size_t i) {
      for (size_t j = begin; j < std::min(i, end); ++j)
        if (boxes_meet(list_[j].box, list_[i].box)) visit(list_[j].number, list_[i].number);
    };
    look_behind({0, 0, list_.size()}, begin, around, look);
  }

 private:
  static constexpr size_t kGroup = 8;

  struct Numbered {
    BoxQ8 box;
    uint32_t number;
  };
  struct Node {
    size_t number, begin, end;  ///< its boxes in list_

    bool is_leaf() const { return end - begin <= 8; }
    Node lower() const { return {2 * number + 1, begin, begin + (end - begin) / 2}; }
    Node upper() const { return {2 * number + 2, begin + (end - begin) / 2, end}; }
  };

  template <class Visit>
  bool for_all_below(const Node& node, const BoxQ8& box, Visit& visit) const {
    if (!boxes_meet(around_[node.number], box)) return true;
    if (!node.is_leaf()) return for_all_below(node.lower(), box, visit) && for_all_below(node.upper(), box, visit);
    for (size_t i = node.begin; i < node.end; ++i)
      if (boxes_meet(list_[i].box, box) && !visit(list_[i].number)) return false;
    return true;
  }
  /// Calls look(i) for the places i of list_, none before `begin`, whose boxes meet this one.
  template <class Look>
  void look_behind(const Node& node, size_t begin, const BoxQ8& box, const Look& look) const {
    if (node.end <= begin || !boxes_meet(around_[node.number], box)) return;
    if (!node.is_leaf()) {
      look_behind(node.lower(), begin, box, look);
      look_behind(node.upper(), begin, box, look);
      return;
    }
    for (size_t i = std::max(node.begin, begin); i < node.end; ++i)
      if (boxes_meet(list_[i].box, box)) look(i);
  }
  void arrange_all();
  void arrange(const Node& node);

  std::vector<Numbered> list_;
  std::vector<BoxQ8> around_;  ///< by node, the smallest box with all of its boxes
};

}  // namespace isoshell
