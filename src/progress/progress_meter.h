// The fraction of a whole run that is done, from what its parts are expected to take.
#pragma once

#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "isoshell/message.h"

namespace isoshell {

/// Of a stage within a step; without a stage, what the step does beside them.
struct ExpectedWork {
  std::string step, stage;
  double seconds = 0;  ///< on the machine that the expectation comes from
};

/// What is left is the sum over the work that is not over, and each decrease of it moves the fraction by the same part
/// of what the fraction has left: so more work than was expected slows the fraction down, and nothing takes it back.
/// While work goes on, its share goes with the time, ever slower as it takes longer than expected; what stages report
/// of themselves corrects that. Work that is late by much moves the whole a little. Nothing is told before the first
/// step has begun. Calls may come from several threads.
class ProgressMeter {
 public:
  using Seconds = std::function<double()>;  ///< a clock that never goes back

  explicit ProgressMeter(TellProgress tell, Seconds now = {});

  bool is_heard() const { return bool(tell_); }
  /// From now on.
  void tell_to(TellProgress tell) { tell_ = std::move(tell); }
  /// From here on, for all steps that have not begun and stages of this step that have not ended.
  void expect(const std::vector<ExpectedWork>& work);
  void begin(const char* step);
  void end(const char* step);
  /// A stage begins (0), goes on or is over (1), as Context::progress says it. Stages within a stage count as that.
  void hear(const char* stage, double fraction);
  /// Time has passed.
  void tick();
  /// The run is over.
  void finish();

 private:
  enum class State { waiting, begun, over };
  struct Work {
    double seconds = 0, left = 0, spent = 0;  ///< expected at first, and from now on; spent by the clock
    State state = State::waiting;
    bool is_planned = true;
  };
  using Key = std::pair<std::string, std::string>;  ///< step, stage

  void settle();
  void go_on_with(const std::string& stage);
  void stop_work();
  void hear_of_work(double fraction);
  void close(Work& work);
  double seconds_left() const;
  double left_of(const char* step) const;
  double pace() const;
  void tell();

  TellProgress tell_;
  const Seconds now_;
  std::mutex mutex_;
  std::map<Key, Work> work_;
  const char* step_ = "";
  bool is_in_step_ = false;
  std::string stage_;  ///< that goes on; empty: what the step does beside them
  Work* current_ = nullptr;
  double start_ = 0, at_ = 0;                      ///< of the run; when it was settled last
  double news_at_ = 0, news_left_ = 0, news_ = 0;  ///< of the current work: when it was heard of, what was left then
  double news_pace_ = 1;
  double whole_ = 0, whole_left_ = 0, part_ = 0, part_left_ = 0;  ///< fractions, and expected seconds, of run and step
  double measured_ = 0,
         pace_sum_ = 0;  ///< planned work that is over, and logarithms of what it took over what it should
};

}  // namespace isoshell
