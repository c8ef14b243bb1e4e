#include "core/parallel_ranges.h"

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <functional>

#include "core/try_threads.h"

namespace isoshell {

using Range = tbb::blocked_range<int64_t>;

namespace {

/// TBB ends the process where it gets no thread: those that it will start are tried before its first loop.
void require_threads() {
  static const int all = tbb::info::default_concurrency() - 1;
  static std::atomic<int> there{0};
  if (there.load(std::memory_order_relaxed) >= all) return;
  const int wanted = tbb::this_task_arena::max_concurrency() - 1;
  if (wanted <= there.load(std::memory_order_relaxed)) return;
  try_threads(wanted);
  there.store(wanted, std::memory_order_relaxed);
}

}  // namespace

void for_ranges(int64_t count, int64_t grain, RangeFunction<void> body) {
  require_threads();
  tbb::parallel_for(Range(0, count, grain), [&](const Range& r) { body(r.begin(), r.end()); });
}

bool loops_run_alone() { return tbb::this_task_arena::max_concurrency() == 1; }

int64_t sum_over_ranges(int64_t count, int64_t grain, RangeFunction<int64_t> part) {
  require_threads();
  return tbb::parallel_reduce(
      Range(0, count, grain), int64_t(0), [&](const Range& r, int64_t sum) { return sum + part(r.begin(), r.end()); },
      std::plus<int64_t>());
}

}  // namespace isoshell
