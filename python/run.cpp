#include "run.h"

#include <nanobind/stl/map.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <type_traits>
#include <utility>

#include "context.h"
#include "errors.h"
#include "isoshell/device_info.h"
#include "isoshell/error.h"
#include "job.h"
#include "source.h"
#include "vdb_isomesh/console.h"
#include "vdb_isomesh/memory.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

/// What one call of Python asks for.
struct Asked {
  tool::Arguments arguments;
  nb::object progress;  ///< callable(stage, fraction), or none
  nb::object tell;      ///< callable(is_warning, text)
};

Asked asked_of(const Source& source, const Keywords& keywords, const std::string& output, bool measure_all,
               nb::object progress, nb::object tell) {
  Asked asked{arguments_of(keywords, output), std::move(progress), std::move(tell)};
  RunRequest& request = asked.arguments.run;
  if (measure_all) request.measures = Measures::all;
  if (!source.is_file()) {
    if (!request.input.format.empty())
      throw Error(ErrorCode::usage, "arguments", "--input-format is for files; leave it out");
    return asked;
  }
  const std::optional<double> iso = request.input.iso;
  request.input = named_input(source.path, request.input.format);
  request.input.iso = iso;
  return asked;
}

Listener listener_of(const Asked& asked, tool::Console& console) {
  Listener listener;
  if (!asked.progress.is_none())
    listener.progress = [&](const std::string& stage, double fraction) { asked.progress(stage, fraction); };
  else if (asked.arguments.run.options.was_given("progress"))
    listener.progress = [&](const std::string& stage, double fraction) { console.progress(stage, fraction); };
  listener.tell = [&](MessageKind kind, const std::string& text) {
    if (kind == MessageKind::note) console.detail(text);
    asked.tell(kind == MessageKind::warning, in_keywords(text));
  };
  return listener;
}

/// Does the work on a thread of its own and in the place's context; `work` makes the product of the request.
template <class Work>
auto watched(Place& place, const Source& source, const Asked& asked, Work work) {
  using Product = std::invoke_result_t<Work, const RunRequest&, Context&>;
  const auto product = std::make_shared<std::optional<Product>>();
  Place::Lease lease(place);
  const std::shared_ptr<Context> context = lease.context();
  const auto job = std::make_shared<Job>(context);
  RunRequest request = asked.arguments.run;
  tool::Console console(asked.arguments.progress, asked.arguments.verbosity);
  const Listener listener = listener_of(asked, console);
  Job* posts = job.get();  // the work ends before the job
  request.tell = [posts](MessageKind kind, const std::string& text) { posts->post(kind, text); };
  request.around_write = [posts](const std::string&, const std::function<void()>& write) {
    posts->write_undisturbed(write);
  };
  context->progress = {};
  if (listener.progress)
    context->progress = [posts](const char* stage, double fraction) { posts->post_progress(stage, fraction); };
  job->start([request = std::move(request), context, product, work = std::move(work)] {
    tool::limit_memory(*context, device_info(*context));
    product->emplace(work(request, *context));
  });
  wait_for(job, listener, source.kept, [&] { lease.lose(); });
  return std::move(**product);
}

RunResult remesh(Place& place, const Source& source, const Keywords& keywords, const std::string& output,
                 bool measure_all, nb::object progress, nb::object tell) {
  const Asked asked = asked_of(source, keywords, output, measure_all, std::move(progress), std::move(tell));
  return watched(place, source, asked, [read = source.read](const RunRequest& request, Context& context) {
    return read ? run(read(request, context), request, context) : run(request, context);
  });
}

nb::dict estimate(Place& place, const Source& source, const Keywords& keywords, nb::object tell) {
  const Asked asked = asked_of(source, keywords, "", false, nb::none(), std::move(tell));
  const RunEstimate e =
      watched(place, source, asked, [read = source.read](const RunRequest& request, Context& context) {
        return read ? dry_run(read(request, context), request, context) : dry_run(request, context);
      });
  nb::dict dict;
  dict["resolution"] = e.resolution;
  dict["voxel_size"] = e.voxel_size_world;
  dict["vertices"] = e.vertices;
  dict["sites"] = e.sites;
  dict["active_voxels"] = e.active_voxels;
  dict["sheet_vertices"] = e.sheet_vertices;
  dict["memory_bytes"] = e.bytes;
  return dict;
}

}  // namespace

void bind_run(nb::module_& m) {
  m.def("remesh", remesh, nb::arg("place"), nb::arg("source"), nb::arg("keywords"), nb::arg("output"),
        nb::arg("measure_all"), nb::arg("progress").none(), nb::arg("tell"));
  m.def(
      "estimate", estimate, nb::arg("place"), nb::arg("source"), nb::arg("keywords"), nb::arg("tell"),
      nb::sig("def estimate(place: Place, source: Source, keywords: collections.abc.Sequence[tuple[str, str | None]], "
              "tell: typing.Any) -> dict[str, typing.Any]"));
  m.def("end_jobs_left_alone", end_jobs_left_alone);
}

}  // namespace isoshell::python
