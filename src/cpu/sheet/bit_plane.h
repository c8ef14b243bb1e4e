// A bit for each voxel of a box.
#pragma once

#include <cstdint>

#include "core/zeroed_memory.h"

namespace isoshell {

/// Bits by index. What lies a word beyond the last may be read.
class BitPlane {
 public:
  explicit BitPlane(int64_t count) : words_(size_t(count / 64 + 2)) {}

  bool operator[](int64_t i) const { return words_[size_t(i >> 6)] >> (i & 63) & 1; }
  void set(int64_t i) { words_[size_t(i >> 6)] |= uint64_t(1) << (i & 63); }
  void clear(int64_t i) { words_[size_t(i >> 6)] &= ~(uint64_t(1) << (i & 63)); }

  /// The 64 bits from i on, the first one lowest.
  uint64_t from(int64_t i) const {
    const uint64_t* words = &words_[size_t(i >> 6)];
    return words[0] >> (i & 63) | words[1] << 1 << (63 - (i & 63));
  }
  /// Sets those of them that are set here.
  void set_from(int64_t i, uint64_t bits) {
    uint64_t* words = &words_[size_t(i >> 6)];
    words[0] |= bits << (i & 63);
    words[1] |= bits >> 1 >> (63 - (i & 63));
  }
  /// Becomes a plane of as many bits; only what differs is written to.
  void become(const BitPlane& other) {
    for (size_t w = 0; w < words_.size(); ++w)
      if (words_[w] != other.words_[w]) words_[w] = other.words_[w];
  }
  const ZeroedVector<uint64_t>& words() const { return words_; }

 private:
  ZeroedVector<uint64_t> words_;
};

}  // namespace isoshell
