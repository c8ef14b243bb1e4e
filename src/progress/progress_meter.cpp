// See progress_meter.h.
#include "progress/progress_meter.h"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace isoshell {
namespace {

constexpr double kTail = 0.01;           ///< seconds that are always left: only the end of the run is its end
constexpr double kUnexpectedPart = .05;  ///< of what is left, for a stage that nobody expected
constexpr double kTrust = .1;            ///< in the table, before anything was measured: as so much of the whole run
constexpr double kLate = 1.5;            ///< times what was left of some work, after which it is late
constexpr double kDrift = .2;            ///< of what is left of the whole, for as long again as the run has taken
constexpr double kLateLeft = .3;         ///< of the time that late work has taken, it may take again
constexpr double kMostOff = 20;          ///< times the time of the table
constexpr double kEnough = .1;           ///< of some work tells how fast it is

/// The geometric mean of all of these is the pace: one stage that takes much longer does not say that all will.
double pace_of(double spent, double expected) {
  return expected * std::log(std::clamp(spent / expected, 1 / kMostOff, kMostOff));
}

double seconds_of_clock() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// How much of a stage is done after so many times the time that it should have taken: at first as much as that, and
/// never all of it.
double done_after(double times) { return times / std::sqrt(1 + times * times); }

void advance(double& fraction, double& left, double now_left) {
  if (now_left < left) fraction += (1 - fraction) * (left - now_left) / left;
  left = now_left;
}

}  // namespace

ProgressMeter::ProgressMeter(TellProgress tell, Seconds now)
    : tell_(std::move(tell)), now_(now ? std::move(now) : seconds_of_clock), start_(now_()), at_(start_) {}

void ProgressMeter::expect(const std::vector<ExpectedWork>& work) {
  const std::lock_guard lock(mutex_);
  settle();
  for (auto& [key, known] : work_)
    if (known.state == State::waiting) known.seconds = known.left = 0;
  for (const ExpectedWork& w : work) {
    Work& known = work_[{w.step, w.stage}];
    if (known.state == State::waiting) known.seconds = known.left = w.seconds;
  }
  whole_left_ = left_of(nullptr);
  part_left_ = left_of(step_);
}

void ProgressMeter::begin(const char* step) {
  const std::lock_guard lock(mutex_);
  settle();
  stop_work();
  step_ = step;
  is_in_step_ = true;
  part_ = 0;
  go_on_with("");
  part_left_ = left_of(step_);
  tell();
}

void ProgressMeter::end(const char* step) {
  const std::lock_guard lock(mutex_);
  settle();
  stop_work();
  for (auto& [key, work] : work_)
    if (key.first == step) close(work);
  settle();
  is_in_step_ = false;
  part_ = 1;
  tell();
}

void ProgressMeter::hear(const char* stage, double fraction) {
  const std::lock_guard lock(mutex_);
  if (!is_in_step_) return;
  settle();
  const bool is_of_current = stage_.empty() ? std::string(step_) == stage : stage_ == stage;
  if (is_of_current && (stage_.empty() || fraction < 1)) {
    hear_of_work(fraction);
  } else if (is_of_current) {
    stop_work();
    close(work_[{step_, stage_}]);
    go_on_with("");
  } else if (stage_.empty() && fraction == 0) {
    stop_work();
    go_on_with(stage);
  }
  settle();
}

void ProgressMeter::tick() {
  const std::lock_guard lock(mutex_);
  settle();
  tell();
}

void ProgressMeter::finish() {
  const std::lock_guard lock(mutex_);
  whole_ = part_ = 1;
  whole_left_ = 0;
  if (tell_) tell_({step_, 1, 1, 0});
}

/// Brings what is left up to the present.
void ProgressMeter::settle() {
  const double now = now_();
  if (current_) {
    current_->spent += now - at_;
    const double times = (now - news_at_) / std::max(news_left_ * news_pace_, kTail);
    current_->left = news_left_ * (1 - done_after(times));
    if (times > kLate) {
      const double drift = kDrift * (now - at_) / std::max(now - start_, kTail);
      whole_ += (1 - whole_) * drift;
      part_ += (1 - part_) * drift;
    }
  }
  at_ = now;
  advance(whole_, whole_left_, left_of(nullptr));
  if (is_in_step_) advance(part_, part_left_, left_of(step_));
}

/// Work that comes again is expected to take as long as it was at first.
void ProgressMeter::go_on_with(const std::string& stage) {
  stage_ = stage;
  Work& work = work_[{step_, stage}];
  if (work.state == State::waiting && work.seconds == 0) {
    work.seconds = work.left = kUnexpectedPart * whole_left_;
    work.is_planned = false;
  }
  if (work.state == State::over) work.left = work.seconds;
  work.state = State::begun;
  current_ = &work;
  news_ = 0;
  news_at_ = at_;
  news_left_ = work.left;
  news_pace_ = pace();
  whole_left_ = left_of(nullptr);
  part_left_ = left_of(step_);
}

void ProgressMeter::stop_work() { current_ = nullptr; }

/// The more of it is done, the more counts what it took.
void ProgressMeter::hear_of_work(double fraction) {
  if (fraction <= news_) return;
  news_ = fraction;
  const double whole = (1 - fraction) * current_->seconds + current_->spent / news_pace_;
  news_at_ = at_;
  news_left_ = current_->left = (1 - fraction) * whole;
}

void ProgressMeter::close(Work& work) {
  if (work.state == State::begun && work.is_planned && work.seconds > 0) {
    measured_ += work.seconds;
    pace_sum_ += pace_of(work.spent, work.seconds);
  }
  work.spent = work.left = 0;
  work.state = State::over;
}

/// Of one step, or of all.
double ProgressMeter::left_of(const char* step) const {
  double left = kTail;
  for (const auto& [key, work] : work_)
    if (!step || key.first == step) left += work.left;
  return left;
}

/// Seconds here for one of the table.
double ProgressMeter::pace() const {
  double measured = measured_, sum = pace_sum_;
  if (current_ && current_->is_planned && news_ > kEnough && news_ < 1 && current_->seconds > 0) {
    measured += news_ * current_->seconds;
    sum += pace_of(current_->spent, news_ * current_->seconds);
  }
  return std::exp(sum / (measured + kTrust * (measured + whole_left_)));
}

double ProgressMeter::seconds_left() const {
  const double left = pace() * (whole_left_ - kTail);
  return current_ ? left + std::max(0., kLateLeft * (at_ - news_at_) - news_pace_ * current_->left) : left;
}

void ProgressMeter::tell() {
  if (tell_ && *step_ != '\0') tell_({step_, whole_, part_, seconds_left()});
}

}  // namespace isoshell
