// Where runs are done, kept from run to run.
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <memory>

#include "isoshell/backend.h"
#include "values/keywords.h"

namespace isoshell::python {

/// The device, threads and memory of runs, one at a time.
class Place {
 public:
  explicit Place(const Keywords& keywords);

  /// The context of one run; while it lives, no other may begin. Throws: usage when one does.
  class Lease {
   public:
    explicit Lease(Place& place);
    ~Lease() { place_->busy_ = false; }
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    const std::shared_ptr<Context>& context() const { return place_->context_; }
    /// The work goes on by itself: what follows gets another context.
    void lose() { place_->renew(); }

   private:
    Place* place_;
  };

  void cancel() { context_->cancel = true; }
  /// 0: what is free when a run begins.
  int64_t max_memory_bytes() const { return settings_.max_memory_bytes; }
  /// Lets go of what is kept on a device.
  void close();

 private:
  void renew();

  tool::Arguments settings_;
  std::shared_ptr<Context> context_;
  std::atomic<bool> busy_{false};
};

void bind_context(nanobind::module_& m);

}  // namespace isoshell::python
