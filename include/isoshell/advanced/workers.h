// Threads that work side by side on different inputs, each in a context of its own.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <type_traits>
#include <utility>
#include <vector>

#include "isoshell/advanced/own_thread.h"
#include "isoshell/backend.h"

namespace isoshell {

/// Used by one thread. Workers take what was begun in that order.
class Workers {
 public:
  /// Contexts with the backend, device, threads and memory limit of this one; its progress is not theirs, and it may
  /// end before them. On the CPU a worker has one thread unless the context says more. Without a count there are as
  /// many workers as fill the cores, and on a device eight, which keep it busy. Throws: no_device; out_of_memory where
  /// the system gives no more threads.
  explicit Workers(const Context& like, int count = 0);
  /// Cancels what is under way, drops what was not taken yet, and returns when all workers have ended.
  ~Workers();
  Workers(const Workers&) = delete;
  Workers& operator=(const Workers&) = delete;

  int count() const { return int(contexts_.size()); }

  /// Has a worker call `work(Context&)`. Result: what that returns or throws; std::future_error of what was dropped.
  template <class Work>
  std::future<std::invoke_result_t<Work&, Context&>> begin(Work work) {
    using Task = std::packaged_task<std::invoke_result_t<Work&, Context&>(Context&)>;
    const auto task = std::make_shared<Task>(std::move(work));
    add([task](Context& context) { (*task)(context); });
    return task->get_future();
  }

 private:
  void add(std::function<void(Context&)> work);
  void work_in(Context& context);
  void end();

  std::deque<Context> contexts_;
  std::vector<OwnThread> threads_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<std::function<void(Context&)>> waiting_;
  bool ended_ = false;
};

}  // namespace isoshell
