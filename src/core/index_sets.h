// Which of numbered things belong together.
#pragma once

#include <vector>

#include "isoshell/advanced/buffer.h"
#include "voxel/union_find.h"

namespace isoshell {

/// Disjoint sets of 0 to count - 1; the root of a set is its smallest member.
class IndexSets {
 public:
  explicit IndexSets(int64_t count) : parent_(count) {
    for (int64_t i = 0; i < count; ++i) parent_[i] = uint32_t(i);
  }
  void unite(uint32_t a, uint32_t b) { join(parent_.view(), a, b); }
  uint32_t root(uint32_t i) { return find_root(parent_.view(), i); }
  /// Per member the number of its set, in the order of the roots; and how many there are.
  std::vector<uint32_t> numbers(uint32_t& count) {
    count = 0;
    std::vector<uint32_t> number(size_t(parent_.size()));
    for (uint32_t i = 0; i < number.size(); ++i) number[i] = root(i) == i ? count++ : number[root(i)];
    return number;
  }

 private:
  Buffer<uint32_t> parent_;
};

}  // namespace isoshell
