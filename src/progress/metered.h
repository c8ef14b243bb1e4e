// Who waits for a run hears how far it is.
#pragma once

#include <condition_variable>
#include <functional>
#include <mutex>

#include "isoshell/advanced/own_thread.h"
#include "isoshell/backend.h"
#include "progress/progress_meter.h"

namespace isoshell {

/// While it lives, the meter hears what stages in the context report, and time as it passes. Nothing is done where
/// nobody hears the meter.
class Metered {
 public:
  Metered(ProgressMeter& meter, Context& context);
  ~Metered();
  Metered(const Metered&) = delete;
  Metered& operator=(const Metered&) = delete;

 private:
  void tick();

  ProgressMeter& meter_;
  Context& context_;
  std::function<void(const char*, double)> own_;  ///< the context's
  std::mutex mutex_;
  std::condition_variable changed_;
  bool is_over_ = false;
  OwnThread thread_;
};

}  // namespace isoshell
