#include "module/job.h"

#include <cstdlib>

#include "isoshell/error.h"
#include "values/errors.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

using namespace std::chrono_literals;
constexpr auto kLook = 50ms, kPatience = 150ms;  // a key is answered within their sum

/// Jobs that did not stop in time, and the objects whose memory they read. Guarded by the interpreter's lock.
struct LeftAlone {
  std::shared_ptr<Job> job;
  nb::object kept;
};
std::vector<LeftAlone>& left_alone() {
  static auto* jobs = new std::vector<LeftAlone>;  // never destroyed: threads may still run when statics are
  return *jobs;
}

void forget_ended_jobs() {
  auto& jobs = left_alone();
  for (size_t i = jobs.size(); i-- > 0;)
    if (jobs[i].job->wait(0ms)) jobs.erase(jobs.begin() + int64_t(i));
}

void check_signals() {
  if (PyErr_CheckSignals() != 0) throw nb::python_error();
}

void deliver(const Mail& mail, const Listener& listener) {
  for (const Mail::Message& m : mail.messages)
    if (listener.tell) listener.tell(m.kind, m.text);
  for (const Progress& progress : mail.progress)
    if (listener.progress) listener.progress(progress);
}

}  // namespace

Job::~Job() {
  if (thread_.joinable()) thread_.join();
}

void Job::start(std::function<void()> work) {
  thread_ = OwnThread([this, work = std::move(work)]() mutable {
    std::exception_ptr thrown;
    try {
      with_errors([&] { work(); });
    } catch (...) {
      thrown = std::current_exception();
    }
    work = nullptr;  // what it holds is not needed while someone may still hold the job
    const std::lock_guard lock(mutex_);
    thrown_ = thrown;
    ended_ = true;
    changed_.notify_all();
  });
}

void Job::post_progress(const Progress& progress) {
  const std::lock_guard lock(mutex_);
  std::vector<Progress>& posted = mail_.progress;
  if (!posted.empty() && std::string(posted.back().stage) == progress.stage && posted.back().stage_fraction > 0)
    posted.back() = progress;
  else
    posted.push_back(progress);
}

void Job::post(MessageKind kind, const std::string& text) {
  const std::lock_guard lock(mutex_);
  mail_.messages.push_back({kind, text});
}

void Job::write_undisturbed(const std::function<void()>& write) {
  const auto count = [this](int by) {
    const std::lock_guard lock(mutex_);
    writing_ += by;
    changed_.notify_all();
  };
  struct Writing {
    const decltype(count)& add;
    ~Writing() { add(-1); }
  };
  count(1);
  const Writing writing{count};
  write();
}

bool Job::wait(std::chrono::milliseconds limit) {
  std::unique_lock lock(mutex_);
  return changed_.wait_for(lock, limit, [this] { return ended_; });
}

Mail Job::take_mail() {
  const std::lock_guard lock(mutex_);
  return std::exchange(mail_, {});
}

bool Job::stop() {
  context_->cancel = true;
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, kPatience, [this] { return ended_; });
  changed_.wait(lock, [this] { return ended_ || writing_ == 0; });
  return ended_;
}

void Job::finish() {
  thread_.join();
  if (thrown_) std::rethrow_exception(thrown_);
}

void wait_for(const std::shared_ptr<Job>& job, const Listener& listener, nb::object kept,
              const std::function<void()>& on_left_alone) {
  forget_ended_jobs();
  for (bool ended = false; !ended;) {
    {
      const nb::gil_scoped_release released;
      ended = job->wait(kLook);
    }
    try {
      check_signals();
      deliver(job->take_mail(), listener);
    } catch (...) {
      bool stopped = false;
      {
        const nb::gil_scoped_release released;
        stopped = job->stop();
      }
      if (!stopped) {
        left_alone().push_back({job, std::move(kept)});
        on_left_alone();
      }
      throw;
    }
  }
  const nb::gil_scoped_release released;
  job->finish();
}

void end_jobs_left_alone() {
  for (LeftAlone& left : left_alone())
    for (bool ended = false; !ended;) {
      {
        const nb::gil_scoped_release released;
        ended = left.job->wait(kLook);
      }
      if (PyErr_CheckSignals() != 0) std::_Exit(int(ErrorCode::interrupted));
    }
  left_alone().clear();
}

}  // namespace isoshell::python
