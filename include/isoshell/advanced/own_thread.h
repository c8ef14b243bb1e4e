// Threads that do not depend on how large a stack the process was started with (ulimit -s).
#pragma once

#include <functional>
#include <future>
#include <memory>
#include <type_traits>
#include <utility>

namespace isoshell {

/// A thread with a stack of kStackBytes, of which it takes what it uses: enough for all that this library does.
class OwnThread {
 public:
  static constexpr size_t kStackBytes = size_t(1) << 23;

  OwnThread() = default;
  /// Begins `work`, which does not throw. Throws: out_of_memory where the system gives no more threads.
  explicit OwnThread(std::function<void()> work);
  OwnThread(OwnThread&& other) noexcept = default;
  OwnThread& operator=(OwnThread&& other) noexcept;
  /// Waits.
  ~OwnThread();

  bool joinable() const { return started_ != nullptr; }
  void join();

 private:
  struct Started;
  struct Forget {
    void operator()(Started* started) const noexcept;
  };
  std::unique_ptr<Started, Forget> started_;
};

/// Runs `work` on such a thread and waits. Result: what it returns or throws. Throws: as OwnThread does.
template <class Work>
auto on_own_thread(Work work) {
  std::packaged_task<std::invoke_result_t<Work&>()> task(std::move(work));
  auto result = task.get_future();
  OwnThread([&] { task(); }).join();
  return result.get();
}

}  // namespace isoshell
