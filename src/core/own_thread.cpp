// Threads that do not depend on how large a stack the process was started with.
#include "isoshell/advanced/own_thread.h"

#include <pthread.h>

#include <cstring>
#include <string>
#include <vector>

#include "core/try_threads.h"
#include "isoshell/error.h"

namespace isoshell {

struct OwnThread::Started {
  std::function<void()> work;
  pthread_t thread;
};

void OwnThread::Forget::operator()(Started* started) const noexcept { delete started; }

OwnThread::OwnThread(std::function<void()> work) : started_(new Started{std::move(work), {}}) {
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstacksize(&attributes, kStackBytes);
  const auto run = [](void* started) -> void* {
    static_cast<Started*>(started)->work();
    return nullptr;
  };
  const int fault = pthread_create(&started_->thread, &attributes, run, started_.get());
  pthread_attr_destroy(&attributes);
  if (fault == 0) return;
  started_.reset();
  throw Error(ErrorCode::out_of_memory, "threads",
              std::string("the system gives no more threads (") + std::strerror(fault) +
                  "); raise the limit of processes (ulimit -u) or of memory (ulimit -v)");
}

OwnThread& OwnThread::operator=(OwnThread&& other) noexcept {
  if (joinable()) join();
  started_ = std::move(other.started_);
  return *this;
}

OwnThread::~OwnThread() {
  if (joinable()) join();
}

void OwnThread::join() {
  pthread_join(started_->thread, nullptr);
  started_.reset();
}

void try_threads(int count) {
  std::promise<void> all_there;
  const std::shared_future<void> wait = all_there.get_future().share();
  std::vector<OwnThread> threads;
  try {
    for (int i = 0; i < count; ++i) threads.emplace_back([wait] { wait.wait(); });
  } catch (...) {
    all_there.set_value();
    throw;
  }
  all_there.set_value();
}

}  // namespace isoshell
