// Work of the library that Python waits for: in the context of a place, with its messages and progress passed on.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "isoshell/device_info.h"
#include "module/context.h"
#include "module/job.h"
#include "values/source.h"
#include "vdb_isomesh/console.h"
#include "vdb_isomesh/memory.h"

namespace isoshell::python {

/// What one call of Python asks for.
struct RequestFromPython {
  tool::Arguments arguments;
  nanobind::object progress;  ///< callable(stage, fraction, stage_fraction, seconds_left), or none
  nanobind::object tell;      ///< callable(is_warning, text)
  std::function<Progress(const Progress&)> in_whole = {};  ///< of what the call is a part of; empty: it is all
};

/// Throws: usage.
RequestFromPython request_from_python(const Source& source, const Keywords& keywords, const std::string& output,
                                      nanobind::object progress, nanobind::object tell);

Listener listener_of(const RequestFromPython& requested, tool::Console& console);

/// Does the work on a thread of its own and in the place's context; `work` makes the product of the request, and holds
/// nothing of Python. Throws: as wait_for does.
template <class Work>
auto watched(Place& place, const Source& source, const RequestFromPython& requested, Work work) {
  using Product = std::invoke_result_t<Work, const RunRequest&, Context&>;
  const auto product = std::make_shared<std::optional<Product>>();
  Place::Lease lease(place);
  const std::shared_ptr<Context> context = lease.context();
  const auto job = std::make_shared<Job>(context);
  RunRequest request = requested.arguments.run;
  tool::Console console(requested.arguments.progress, requested.arguments.verbosity, "isoshell");
  const Listener listener = listener_of(requested, console);
  Job* posts = job.get();  // the work ends before the job
  request.tell = [posts](MessageKind kind, const std::string& text) { posts->post(kind, text); };
  request.around_write = [posts](const std::string&, const std::function<void()>& write) {
    posts->write_undisturbed(write);
  };
  if (listener.progress)
    request.progress = [posts, in_whole = requested.in_whole](const Progress& progress) {
      posts->post_progress(in_whole ? in_whole(progress) : progress);
    };
  job->start([request = std::move(request), context, product, work = std::move(work)] {
    tool::limit_memory(*context, device_info(*context));
    product->emplace(work(request, *context));
  });
  wait_for(job, listener, source.kept, [&] { lease.lose(); });
  return std::move(**product);
}

}  // namespace isoshell::python
