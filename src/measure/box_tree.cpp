// BoxTree (see box_tree.h).
#include "measure/box_tree.h"

#include <tbb/parallel_invoke.h>

#include <algorithm>

namespace isoshell {
namespace {

constexpr size_t kParallel = 4096;  ///< boxes from which on two threads pay

int longest_axis(const BoxQ8& b) {
  const int64_t x = int64_t(b.max.x) - b.min.x, y = int64_t(b.max.y) - b.min.y, z = int64_t(b.max.z) - b.min.z;
  return x >= y && x >= z ? 0 : (y >= z ? 1 : 2);
}

int64_t twice_middle(const BoxQ8& b, int axis) {
  return axis == 0 ? int64_t(b.min.x) + b.max.x : axis == 1 ? int64_t(b.min.y) + b.max.y : int64_t(b.min.z) + b.max.z;
}

}  // namespace

void BoxTree::arrange_all() {
  if (list_.empty()) return;
  Node last{0, 0, list_.size()};  // the larger half is above, so no node has a larger number
  while (!last.is_leaf()) last = last.upper();
  around_.resize(last.number + 1);
  arrange({0, 0, list_.size()});
}

void BoxTree::arrange(const Node& node) {
  BoxQ8& around = around_[node.number];
  around = list_[node.begin].box;
  for (size_t i = node.begin + 1; i < node.end; ++i) around = joined(around, list_[i].box);
  if (node.is_leaf()) return;
  const auto at = [&](size_t i) { return list_.begin() + std::ptrdiff_t(i); };
  const int axis = longest_axis(around);
  std::nth_element(at(node.begin), at(node.upper().begin), at(node.end), [&](const Numbered& a, const Numbered& b) {
    const int64_t u = twice_middle(a.box, axis), v = twice_middle(b.box, axis);
    return u != v ? u < v : a.number < b.number;
  });
  if (node.end - node.begin < kParallel) return arrange(node.lower()), arrange(node.upper());
  tbb::parallel_invoke([&] { arrange(node.lower()); }, [&] { arrange(node.upper()); });
}

}  // namespace isoshell
