// Rows of a file, formatted in parallel, a batch of blocks at a time, and written in order.
#pragma once

#include <algorithm>
#include <charconv>
#include <string>
#include <vector>

#include "core/parallel_ranges.h"
#include "io/bytes/byte_order.h"
#include "io/bytes/output_file.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

constexpr int64_t kRowsPerBlock = 1 << 14, kBlocksPerBatch = 64;

/// Bytes of one block of rows; the largest row is known, so rows are appended without a check.
class RowBuffer {
 public:
  void reserve(int64_t bytes) {
    bytes_.resize(size_t(bytes));
    at_ = bytes_.data();
  }
  void put(char c) { *at_++ = c; }
  void put(const std::string& text) { at_ = std::copy(text.begin(), text.end(), at_); }
  void put_number(double value) { at_ = std::to_chars(at_, bytes_.data() + bytes_.size(), value).ptr; }
  void put_number(float value) { at_ = std::to_chars(at_, bytes_.data() + bytes_.size(), value).ptr; }
  void put_number(uint32_t value) { at_ = std::to_chars(at_, bytes_.data() + bytes_.size(), value).ptr; }
  template <class T>
  void put_binary(T value) {
    const auto bytes = little_endian_bytes(value);
    at_ = std::copy(bytes.begin(), bytes.end(), at_);
  }
  const char* data() const { return bytes_.data(); }
  int64_t size() const { return at_ - bytes_.data(); }

 private:
  std::vector<char> bytes_;
  char* at_ = nullptr;
};

/// put(row, buffer) appends at most `largest_row` bytes.
template <class Put>
void write_rows(OutputFile& file, int64_t count, int64_t largest_row, Put put) {
  std::vector<RowBuffer> blocks(size_t(std::min(kBlocksPerBatch, (count + kRowsPerBlock - 1) / kRowsPerBlock)));
  for (int64_t base = 0; base < count; base += kBlocksPerBatch * kRowsPerBlock) {
    const int64_t here = std::min(kBlocksPerBatch, (count - base + kRowsPerBlock - 1) / kRowsPerBlock);
    for_each_index(int64_t(0), here, [&](int64_t b) {
      const int64_t first = base + b * kRowsPerBlock, last = std::min(count, first + kRowsPerBlock);
      blocks[size_t(b)].reserve((last - first) * largest_row);
      for (int64_t row = first; row < last; ++row) put(row, blocks[size_t(b)]);
    });
    for (int64_t b = 0; b < here; ++b) file.write(blocks[size_t(b)].data(), blocks[size_t(b)].size());
  }
}

constexpr int64_t kLongestDouble = 24, kLongestIndex = 10;

inline void put_text(RowBuffer& out, const WorldPoint& p) {
  out.put_number(p.x);
  out.put(' ');
  out.put_number(p.y);
  out.put(' ');
  out.put_number(p.z);
}

}  // namespace isoshell
