// What all work obeys, in the backend or beside it: the context's thread limit, and its wish to stop.
#pragma once

#include <tbb/info.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "isoshell/backend.h"
#include "isoshell/error.h"

namespace isoshell {

/// Throws Error{interrupted} when the context was cancelled.
inline void check_cancel(const Context& context, const char* stage) {
  if (context.cancel.load(std::memory_order_relaxed)) throw Error(ErrorCode::interrupted, stage, "interrupted");
}

/// The same, but a look once in so many calls that it costs nothing.
class CancelWatch {
 public:
  CancelWatch(const Context& context, const char* stage) : context_(context), stage_(stage) {}
  void check() {
    if (calls_++ % 1024 == 0) check_cancel(context_, stage_);
  }

 private:
  const Context& context_;
  const char* stage_;
  int64_t calls_ = 0;
};

/// Runs `work` with at most context.threads threads, and no more than there are: TBB complains on standard error then.
template <class Work>
auto run_with_threads(const Context& context, Work work) {
  if (context.threads <= 0) return work();
  tbb::task_arena arena(std::min(context.threads, tbb::info::default_concurrency()));
  return arena.execute(work);
}

}  // namespace isoshell
