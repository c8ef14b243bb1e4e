// How much memory the reading of an input may take.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>

namespace isoshell {

/// What the reading of one input and of the files that it names holds, against the limit of its run. A source of bytes
/// has one; what grows with a file is counted before it is there (MeshSource::take, make_room, resize_counted).
class ReadingBudget {
 public:
  ReadingBudget() = default;  ///< without a limit
  /// 0 means no limit.
  explicit ReadingBudget(int64_t limit_bytes) : limit_bytes_(limit_bytes) {}
  ReadingBudget(const ReadingBudget&) = delete;
  ReadingBudget& operator=(const ReadingBudget&) = delete;

  /// From any thread. Throws: out_of_memory, which names `input`, where more than the limit would be held; then nothing
  /// is counted.
  void take(int64_t bytes, const std::string& input);
  void give_back(int64_t bytes) noexcept { held_bytes_ -= bytes; }
  int64_t held_bytes() const { return held_bytes_; }

 private:
  const int64_t limit_bytes_ = 0;
  std::atomic<int64_t> held_bytes_{0};
};

}  // namespace isoshell
