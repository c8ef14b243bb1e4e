#include "core/parallel_ranges.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
#include <tbb/task_arena.h>

#include <functional>

namespace isoshell {

using Range = tbb::blocked_range<int64_t>;

void for_ranges(int64_t count, int64_t grain, RangeFunction<void> body) {
  tbb::parallel_for(Range(0, count, grain), [&](const Range& r) { body(r.begin(), r.end()); });
}

bool loops_run_alone() { return tbb::this_task_arena::max_concurrency() == 1; }

int64_t sum_over_ranges(int64_t count, int64_t grain, RangeFunction<int64_t> part) {
  return tbb::parallel_reduce(
      Range(0, count, grain), int64_t(0), [&](const Range& r, int64_t sum) { return sum + part(r.begin(), r.end()); },
      std::plus<int64_t>());
}

}  // namespace isoshell
