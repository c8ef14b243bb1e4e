// The corners of triangles by their vertices, while vertices go into others.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// Per vertex a list of its corners: corner 3 t + i is the one at place i of triangle t. A vertex without a list is
/// gone. Lists of different vertices may change at once.
class CornerLists {
 public:
  CornerLists(size_t corners, size_t vertices)
      : next_(corners, kNone), first_(vertices, kNone), last_(vertices, kNone) {}

  bool is_there(uint32_t vertex) const { return first_[vertex] != kNone; }
  void add(uint32_t vertex, uint32_t corner) { append(vertex, corner, corner); }
  /// Gives all corners of a vertex, which is gone then, to another one, behind its own.
  void take_into(uint32_t gone, uint32_t into) {
    append(into, first_[gone], last_[gone]);
    first_[gone] = kNone;
  }
  /// Calls visit(corner) for each, those of triangles that are gone, too.
  template <class Visit>
  void for_each(uint32_t vertex, Visit visit) const {
    for (uint32_t c = first_[vertex]; c != kNone; c = next_[c]) visit(c);
  }

 private:
  void append(uint32_t vertex, uint32_t first, uint32_t last) {
    (first_[vertex] == kNone ? first_[vertex] : next_[last_[vertex]]) = first;
    last_[vertex] = last;
  }

  std::vector<uint32_t> next_;          ///< per corner the next one of its vertex
  std::vector<uint32_t> first_, last_;  ///< per vertex
};

}  // namespace isoshell
