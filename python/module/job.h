// Work that Python waits for: on a thread of its own, so that the one of Python can answer signals and call back.
#pragma once

#include <nanobind/nanobind.h>

#include <chrono>
#include <condition_variable>
#include <exception>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "isoshell/advanced/own_thread.h"
#include "isoshell/backend.h"
#include "isoshell/message.h"

namespace isoshell::python {

/// Who hears what happens meanwhile; called by the thread that waits, with the interpreter's lock held.
struct Listener {
  TellProgress progress;  ///< empty: nobody
  Tell tell;
};

/// What came from the work since the last look. Of a stage's progress only the latest is kept.
struct Mail {
  struct Message {
    MessageKind kind;
    std::string text;
  };
  std::vector<Progress> progress;
  std::vector<Message> messages;
};

class Job {
 public:
  /// `context` is the one that the work runs in, and no other job's.
  explicit Job(std::shared_ptr<Context> context) : context_(std::move(context)) {}
  ~Job();
  Job(const Job&) = delete;
  Job& operator=(const Job&) = delete;

  void start(std::function<void()> work);

  // For the work.
  void post_progress(const Progress& progress);
  void post(MessageKind kind, const std::string& text);
  /// A file that is being written is finished, or removed, before the job is left alone.
  void write_undisturbed(const std::function<void()>& write);

  // For the thread that waits.
  /// Whether the work has ended, after at most that long.
  bool wait(std::chrono::milliseconds limit);
  Mail take_mail();
  /// Asks the work to stop. Whether it has, soon.
  bool stop();
  /// After the work has ended: throws what it threw.
  void finish();

 private:
  std::shared_ptr<Context> context_;
  OwnThread thread_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool ended_ = false;
  int writing_ = 0;
  Mail mail_;
  std::exception_ptr thrown_;
};

/// Waits for a job that was started, with the interpreter's lock let go, and delivers its mail. Throws what the work
/// threw, or what a signal or the listener raised: then the work is asked to stop, and left alone where it does not do
/// so in time. `kept` lives as long as the work, and `on_left_alone` is called when its context is lost to it.
void wait_for(const std::shared_ptr<Job>& job, const Listener& listener, nanobind::object kept,
              const std::function<void()>& on_left_alone);

/// Ends what is left of jobs that were left alone; the interpreter calls it when it ends.
void end_jobs_left_alone();

}  // namespace isoshell::python
