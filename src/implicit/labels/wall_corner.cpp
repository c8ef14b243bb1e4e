// See wall_corner.h.
#include "implicit/labels/wall_corner.h"

#include <algorithm>

namespace isoshell {
namespace {

/// Arcs that are one sheet, the smallest arc standing for all of its sheet.
class Sheets {
 public:
  Sheets() {
    for (int a = 0; a < kArcs; ++a) parent_[a] = uint8_t(a);
  }
  int of(int arc) const {
    while (parent_[arc] != arc) arc = parent_[arc];
    return arc;
  }
  void join(int a, int b) {
    a = of(a);
    b = of(b);
    parent_[std::max(a, b)] = uint8_t(std::min(a, b));
  }

 private:
  uint8_t parent_[kArcs];
};

/// Along the lattice edge that leaves the corner on one side along an axis.
void join_along_edge(const std::array<int32_t, 8>& label, int axis, int side, Sheets& sheets) {
  const int u = 1 << (axis + 1) % 3, v = 1 << (axis + 2) % 3, first = side << axis;
  const int octant[4] = {first, first | u, first | u | v, first | v};
  const WallEdge edge(
      {label[size_t(octant[0])], label[size_t(octant[1])], label[size_t(octant[2])], label[size_t(octant[3])]});
  int first_of_pair[2] = {-1, -1};
  for (int i = 0; i < 4; ++i) {
    if (!edge.is_wall[i]) continue;
    const int from = octant[i], to = octant[(i + 1) % 4];
    const int arc = arc_of(std::min(from, to), i % 2 == 0 ? (axis + 1) % 3 : (axis + 2) % 3);
    int& other = first_of_pair[edge.pair_of(i)];
    if (other < 0)
      other = arc;
    else
      sheets.join(other, arc);
  }
}

}  // namespace

WallCorner::WallCorner(const std::array<int32_t, 8>& label) {
  Sheets joined;
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) join_along_edge(label, axis, side, joined);
  sheet_of_arc.fill(kNoSheet);
  for (int axis = 0; axis < 3; ++axis)
    for (int o = 0; o < 8; ++o) {
      if (o >> axis & 1 || label[size_t(o)] == label[size_t(o | 1 << axis)]) continue;
      const int arc = arc_of(o, axis), first = joined.of(arc);
      sheet_of_arc[size_t(arc)] = first == arc ? uint8_t(sheets++) : sheet_of_arc[size_t(first)];
    }
}

}  // namespace isoshell
