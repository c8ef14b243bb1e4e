// See reflex_corners.h.
#include "io/faces/reflex_corners.h"

#include <algorithm>
#include <utility>

namespace isoshell {

void ReflexCorners::build(std::vector<uint32_t> corners, const std::vector<PlanePosition>& at) {
  at_ = &at;
  corner_ = std::move(corners);
  leaf_of_.assign(at.size(), kNowhere);
  size_t leaves = 1;
  while (leaves * kFewCorners < corner_.size()) leaves *= 2;
  node_.assign(2 * leaves, {});
  build_node(1, 0, uint32_t(corner_.size()));
}

void ReflexCorners::build_node(uint32_t node, uint32_t first, uint32_t end) {
  Node& n = node_[node];
  n.first = first;
  n.end = end;
  n.present = end - first;
  if (first == end) return;
  n.low = n.high = (*at_)[corner_[first]];
  for (uint32_t i = first; i < end; ++i) {
    const PlanePosition p = (*at_)[corner_[i]];
    n.low = {std::min(n.low.u, p.u), std::min(n.low.v, p.v)};
    n.high = {std::max(n.high.u, p.u), std::max(n.high.v, p.v)};
  }
  if (2 * node >= node_.size()) {
    for (uint32_t i = first; i < end; ++i) leaf_of_[corner_[i]] = node;
    return;
  }
  const bool along_u = n.high.u - n.low.u > n.high.v - n.low.v;
  const uint32_t middle = first + (end - first) / 2;
  std::nth_element(corner_.begin() + first, corner_.begin() + middle, corner_.begin() + end,
                   [&](uint32_t i, uint32_t j) {
                     const PlanePosition p = (*at_)[i], q = (*at_)[j];
                     return along_u ? p.u < q.u : p.v < q.v;
                   });
  build_node(2 * node, first, middle);
  build_node(2 * node + 1, middle, end);
}

void ReflexCorners::remove(uint32_t corner) {
  for (uint32_t node = std::exchange(leaf_of_[corner], kNowhere); node != kNowhere && node > 0; node /= 2)
    --node_[node].present;
}

}  // namespace isoshell
