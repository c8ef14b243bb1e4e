// Loops over threads whose machinery is compiled once: a loop of TBB that is a template of its body costs a kilobyte
// and a tenth of a second of the compiler for every body there is. What is paid instead is one indirect call a range.
#pragma once

#include <algorithm>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace isoshell {

/// A function of the range [begin, end) that lives elsewhere, as long as the call that it is given to.
template <class Result>
class RangeFunction {
 public:
  template <class Body, class = std::enable_if_t<!std::is_same_v<std::decay_t<Body>, RangeFunction>>>
  RangeFunction(const Body& body)  // NOLINT(google-explicit-constructor): so that a lambda can be given
      : body_(&body), call_([](const void* b, int64_t begin, int64_t end) -> Result {
          return (*static_cast<const Body*>(b))(begin, end);
        }) {}

  Result operator()(int64_t begin, int64_t end) const { return call_(body_, begin, end); }

 private:
  const void* body_;
  Result (*call_)(const void*, int64_t, int64_t);
};

/// Calls `body` for ranges that together are [0, count), in any order and from several threads. No range of `grain`
/// elements or fewer is cut further. What `body` throws is thrown here.
void for_ranges(int64_t count, int64_t grain, RangeFunction<void> body);

/// Whether only the calling thread runs the loops that it starts here.
bool loops_run_alone();

/// Calls `body` for every index from `begin` to `end`, which is not one of them, in any order and from several threads.
template <class Index, class Body>
void for_each_index(Index begin, Index end, const Body& body) {
  if (end <= begin) return;
  for_ranges(int64_t(end - begin), 1, [&](int64_t first, int64_t last) {
    for (int64_t i = first; i < last; ++i) body(Index(begin + Index(i)));
  });
}

/// The sum of what `part` gives for such ranges.
int64_t sum_over_ranges(int64_t count, int64_t grain, RangeFunction<int64_t> part);

/// What `at` gives for every index below `count`, joined; joined with `start` a value stays as it is. Chunks of fixed
/// size are joined in order: the same for any number of threads, sums of doubles, too.
template <class Value, class At, class Join>
Value joined_over(size_t count, const Value& start, const At& at, const Join& join) {
  constexpr size_t kChunk = 4096;
  std::vector<Value> chunks((count + kChunk - 1) / kChunk, start);
  for_each_index(size_t(0), chunks.size(), [&](size_t c) {
    const size_t end = std::min(count, (c + 1) * kChunk);
    for (size_t i = c * kChunk; i < end; ++i) chunks[c] = join(chunks[c], at(i));
  });
  Value all = start;
  for (const Value& chunk : chunks) all = join(all, chunk);
  return all;
}

}  // namespace isoshell
