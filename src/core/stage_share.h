// Stages that are parts of another.
#pragma once

#include <algorithm>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "isoshell/backend.h"

namespace isoshell {

/// While it lives, what stages in the context report counts as a part of the whole stage, from one fraction of it to
/// another.
class StageShare {
 public:
  StageShare(Context& context, double begin, double end) : context_(context), whole_(std::move(context.progress)) {
    if (!whole_) return;
    context.progress = [this, begin, end](const char* stage, double fraction) {
      whole_(stage, begin + (end - begin) * fraction);
    };
  }
  ~StageShare() { context_.progress = std::move(whole_); }
  StageShare(const StageShare&) = delete;
  StageShare& operator=(const StageShare&) = delete;

 private:
  Context& context_;
  std::function<void(const char*, double)> whole_;
};

/// Parts of a stage, one after the other, and how long they take beside one another.
class StageParts {
 public:
  StageParts(Context& context, std::vector<double> weights) : context_(context), weights_(std::move(weights)) {
    all_ = std::accumulate(weights_.begin(), weights_.end(), 0.0);
  }

  StageShare next() {
    const double begin = done_;
    if (at_ < weights_.size()) done_ = std::min(1.0, done_ + weights_[at_++] / all_);
    return StageShare(context_, begin, done_);
  }

 private:
  Context& context_;
  std::vector<double> weights_;
  size_t at_ = 0;
  double all_ = 0, done_ = 0;
};

}  // namespace isoshell
