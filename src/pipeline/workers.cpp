#include "isoshell/advanced/workers.h"

#include <tbb/info.h>

#include <algorithm>
#include <string>

namespace isoshell {
namespace {

constexpr int kOnDevice = 8;  ///< bench/results/contexts_cuda.md

}  // namespace

Workers::Workers(const Context& like, int count) {
  const bool on_cpu = std::string(backend_name(like)) == "cpu";
  const int threads = like.threads == 0 && on_cpu ? 1 : like.threads;
  if (count <= 0) count = on_cpu ? std::max(1, tbb::info::default_concurrency() / threads) : kOnDevice;
  for (int i = 0; i < count; ++i) {
    Context& own = contexts_.emplace_back();
    own.backend = like.backend;
    own.device = like.device;
    own.threads = threads;
    own.memory_limit_bytes = like.memory_limit_bytes;
  }
  try {
    for (Context& own : contexts_) threads_.emplace_back([this, &own] { work_in(own); });
  } catch (...) {  // no more threads are to be had
    end();
    throw;
  }
}

Workers::~Workers() { end(); }

void Workers::add(std::function<void(Context&)> work) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(work));
  changed_.notify_one();
}

void Workers::work_in(Context& context) {
  for (;;) {
    std::function<void(Context&)> work;
    {
      std::unique_lock lock(mutex_);
      changed_.wait(lock, [this] { return ended_ || !waiting_.empty(); });
      if (ended_) return;
      work = std::move(waiting_.front());
      waiting_.pop_front();
    }
    work(context);
  }
}

void Workers::end() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    waiting_.clear();
  }
  for (Context& context : contexts_) context.cancel = true;
  changed_.notify_all();
  for (OwnThread& thread : threads_) thread.join();
}

}  // namespace isoshell
