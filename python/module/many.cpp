#include "module/many.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <chrono>
#include <future>
#include <memory>
#include <utility>
#include <vector>

#include "isoshell/advanced/workers.h"
#include "module/watched.h"
#include "values/errors.h"
#include "values/result.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

using namespace std::chrono_literals;

/// What runs read that nobody waits for any more, until their workers have ended.
using LeftBehind = std::vector<nb::object>;

/// A run that was begun. It keeps what the run reads, or leaves it behind where that has not ended: to wait for it
/// could take as long as a run takes, as nothing has cancelled it yet.
class BegunRun {
 public:
  BegunRun(RequestFromPython requested, nb::object kept, std::shared_ptr<LeftBehind> left)
      : requested_(std::move(requested)), kept_(std::move(kept)), left_(std::move(left)) {}
  BegunRun(BegunRun&&) = default;
  ~BegunRun() {
    if (!has_ended()) left_->push_back(std::move(kept_));
  }

  void begin(Workers& workers, ReadMemory read, bool measure_all) {
    RunRequest request = requested_.arguments.run;
    if (measure_all) request.measures = Measures::all;
    request.tell = [messages = messages_](MessageKind kind, const std::string& text) {
      messages->push_back({kind, text});
    };
    const int64_t limit_bytes = requested_.arguments.max_memory_bytes;
    result_ = workers.begin([request = std::move(request), read = std::move(read), limit_bytes](Context& context) {
      context.memory_limit_bytes = limit_bytes;  // 0: by what is free when the run begins
      tool::limit_memory(context, device_info(context));
      return run_from(read, request, context);
    });
  }

  bool has_ended() const { return !result_.valid() || result_.wait_for(0ms) == std::future_status::ready; }

  /// Waits, delivers the messages of the run, and throws what it threw, or what a signal raised.
  MadeResult result() {
    for (bool ended = false; !ended;) {
      {
        const nb::gil_scoped_release released;
        ended = result_.wait_for(50ms) == std::future_status::ready;
      }
      if (PyErr_CheckSignals() != 0) throw nb::python_error();
    }
    tool::Console console(requested_.arguments.progress, requested_.arguments.verbosity, "isoshell");
    const Listener listener = listener_of(requested_, console);
    for (const Mail::Message& message : *messages_) listener.tell(message.kind, message.text);
    return with_errors([&] { return made_of(result_.get()); });
  }

 private:
  RequestFromPython requested_;
  nb::object kept_;
  std::shared_ptr<LeftBehind> left_;
  std::shared_ptr<std::vector<Mail::Message>> messages_ = std::make_shared<std::vector<Mail::Message>>();
  std::future<RunResult> result_;
};

/// Workers for runs with these options.
class RunWorkers {
 public:
  RunWorkers(const Keywords& keywords, int count) {
    const tool::Arguments arguments = arguments_of(keywords, "");
    Context like;
    like.backend = arguments.backend;
    like.device = arguments.device;
    like.threads = arguments.threads;
    workers_ = std::make_unique<Workers>(like, count);
  }
  ~RunWorkers() { close(); }

  BegunRun begin(const Source& source, const Keywords& keywords, bool measure_all, nb::object tell) {
    BegunRun run(request_from_python(source, keywords, "", nb::none(), std::move(tell)), source.kept, left_);
    run.begin(*workers_, source.read, measure_all);
    return run;
  }

  int count() const { return workers_->count(); }

  void close() {
    {
      const nb::gil_scoped_release released;
      workers_.reset();
    }
    left_->clear();
  }

 private:
  std::shared_ptr<LeftBehind> left_ = std::make_shared<LeftBehind>();
  std::unique_ptr<Workers> workers_;  ///< null when they are closed
};

}  // namespace

void bind_many(nb::module_& m) {
  nb::class_<BegunRun>(m, "BegunRun", "A run that workers were given.")
      .def("has_ended", &BegunRun::has_ended)
      .def("result", &BegunRun::result);
  nb::class_<RunWorkers>(m, "RunWorkers", "Threads that make runs side by side, each in a context of its own.")
      .def(nb::init<const Keywords&, int>(), nb::arg("keywords"), nb::arg("count"))
      .def("begin", &RunWorkers::begin, nb::arg("source"), nb::arg("keywords"), nb::arg("measure_all"), nb::arg("tell"))
      .def("close", &RunWorkers::close, "Cancel what is under way, and wait until it has ended.")
      .def_prop_ro("count", &RunWorkers::count);
}

}  // namespace isoshell::python
