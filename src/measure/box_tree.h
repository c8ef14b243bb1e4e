// Which boxes on the lattice meet a box.
#pragma once

#include <cstddef>
#include <vector>

#include "geometry/box.h"

namespace isoshell {

/// A balanced tree of boxes: each node halves its boxes by their middles, along the axis on which it is longest. Node n
/// has the nodes 2 n + 1 and 2 n + 2 below it.
class BoxTree {
 public:
  /// Cost: n log n for n boxes, in parallel.
  explicit BoxTree(const std::vector<BoxQ8>& boxes);

  /// Calls visit(i) for each box i that meets this one, in any order, while that returns true. Result: whether all did.
  template <class Visit>
  bool for_all_meeting(const BoxQ8& box, Visit visit) const {
    return list_.empty() || for_all_below({0, 0, list_.size()}, box, visit);
  }

 private:
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
  void arrange(const Node& node);

  std::vector<Numbered> list_;
  std::vector<BoxQ8> around_;  ///< by node, the smallest box with all of its boxes
};

}  // namespace isoshell
