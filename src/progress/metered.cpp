// See metered.h.
#include "progress/metered.h"

#include <chrono>
#include <utility>

#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr auto kTick = std::chrono::milliseconds(200);

}  // namespace

Metered::Metered(ProgressMeter& meter, Context& context) : meter_(meter), context_(context) {
  if (!meter_.is_heard()) return;
  own_ = std::move(context_.progress);
  context_.progress = [this](const char* stage, double fraction) {
    meter_.hear(stage, fraction);
    if (own_) own_(stage, fraction);
  };
  try {
    thread_ = OwnThread([this] { tick(); });
  } catch (const Error&) {  // no more threads are to be had: then only the steps are heard
  }
}

Metered::~Metered() {
  if (!meter_.is_heard()) return;
  {
    const std::lock_guard lock(mutex_);
    is_over_ = true;
  }
  changed_.notify_all();
  if (thread_.joinable()) thread_.join();
  context_.progress = std::move(own_);
}

void Metered::tick() {
  std::unique_lock lock(mutex_);
  while (!changed_.wait_for(lock, kTick, [this] { return is_over_; })) meter_.tick();
}

}  // namespace isoshell
