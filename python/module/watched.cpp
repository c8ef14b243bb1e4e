#include "module/watched.h"

#include <utility>

#include "isoshell/error.h"
#include "values/errors.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {

namespace {

/// As the name of a file with a sizing field does it, which is read later.
void set_sizing(const std::shared_ptr<const SizingField>& sizing, RequestedOptions& options) {
  options.values.sizing = sizing;
  if (!options.was_given("vertices")) options.values.vertices.reset();
  options.given.push_back("sizing");
}

}  // namespace

RequestFromPython request_from_python(const Source& source, const Keywords& keywords, const std::string& output,
                                      nb::object progress, nb::object tell) {
  RequestFromPython requested{arguments_of(keywords, output), std::move(progress), std::move(tell)};
  RunRequest& request = requested.arguments.run;
  request.input.given_grids = source.grids;
  if (source.sizing) set_sizing(source.sizing, request.options);
  if (!source.is_file()) {
    if (!request.input.format.empty())
      throw Error(ErrorCode::usage, "arguments", "--input-format is for files; leave it out");
    return requested;
  }
  request.input.also = source.also;
  request.input = named_input(source.path, std::move(request.input));
  return requested;
}

Listener listener_of(const RequestFromPython& requested, tool::Console& console) {
  Listener listener;
  if (!requested.progress.is_none())
    listener.progress = [&](const Progress& p) {
      requested.progress(p.stage, p.fraction, p.stage_fraction, p.seconds_left);
    };
  else if (requested.arguments.run.options.was_given("progress"))
    listener.progress = [&](const Progress& progress) { console.progress(progress); };
  listener.tell = [&](MessageKind kind, const std::string& text) {
    if (kind == MessageKind::note) console.detail(text);
    requested.tell(kind == MessageKind::warning, in_keywords(text));
  };
  return listener;
}

}  // namespace isoshell::python
