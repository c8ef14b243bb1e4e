// Where a stage runs, with how much memory, and how it is watched and stopped.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>

namespace isoshell {

enum class Backend { best, cpu, cuda };

class DeviceStream;

/// Passed to every stage, by one thread at a time. Not copied; outlives the call. Products of one context may be given
/// to another: one that works on a device copies them first where it did not make them itself. A product must not be
/// changed or destroyed while a stage of another context takes it.
struct Context {
  Backend backend = Backend::best;
  int device = 0;                  ///< CUDA device number
  int threads = 0;                 ///< CPU threads; 0 means all
  int64_t memory_limit_bytes = 0;  ///< 0 means no limit
  /// Called from the calling thread with the stage's name and the fraction of the stage that is done.
  std::function<void(const char* stage, double fraction)> progress;
  /// Set from any thread or a signal handler; the stage throws Error{interrupted} soon after.
  std::atomic<bool> cancel{false};

 private:
  friend class DeviceStream;             // of the library, in cuda/runtime
  std::shared_ptr<void> backend_state_;  ///< what the backend keeps from call to call; made at first use
};

/// Returns when everything that the context's stages left to a device is done: what times a stage ends with it.
void finish_stages(Context& context);

/// "cpu" or "cuda": where this context's stages run. Throws: no_device when it asks for CUDA and there is none.
const char* backend_name(const Context& context);

}  // namespace isoshell
