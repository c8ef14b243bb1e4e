#include "module/mesh_info.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <functional>
#include <optional>
#include <utility>

#include "isoshell/run/mesh_info.h"
#include "module/watched.h"
#include "values/errors.h"
#include "values/keywords.h"
#include "values/text.h"
#include "vdb_meshinfo/command.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

/// What both borrow.
nb::object kept_of(const Source& a, const Source& b) {
  nb::list kept;
  for (const nb::object& borrowed : {a.kept, b.kept})
    if (borrowed.is_valid()) kept.append(borrowed);
  return std::move(kept);
}

/// The certificate as JSON, and the gates that it misses.
nb::tuple mesh_info_of(Place& place, const Source& source, const Keywords& keywords, const Source* reference,
                       const Keywords& reference_keywords, nb::object progress, nb::object tell) {
  const RequestFromPython requested = request_from_python(source, keywords, "", std::move(progress), std::move(tell));
  Source both = source;
  std::optional<RunRequest> of_reference;
  if (reference) {
    of_reference = request_from_python(*reference, reference_keywords, "", nb::none(), nb::none()).arguments.run;
    both.kept = kept_of(source, *reference);
  }
  const MeshInfo info =
      watched(place, both, requested,
              [read = source.read, of_reference, read_reference = reference ? reference->read : ReadMemory()](
                  const RunRequest& request, Context& context) {
                std::function<Input()> read_other;
                if (of_reference)
                  read_other = [&] {
                    RunRequest again = *of_reference;
                    again.tell = request.tell;
                    again.input.keep_points = true;
                    return input_of_run(read_reference, again, context);
                  };
                return mesh_info([&] { return input_of_run(read, request, context); }, read_other, request.gates,
                                 context, request.progress);
              });
  return nb::make_tuple(mesh_info_json(info), info.missed_gates);
}

/// A file by its name, as Python's `open` makes a source of it.
std::optional<Input> read_by(const nb::object& open, const InputRequest& asked, Context& context, const Tell& tell) {
  const nb::gil_scoped_acquire acquired;
  try {
    const nb::object opened = open(asked.path);
    if (opened.is_none()) return std::nullopt;
    const auto& [source, warnings] = nb::cast<std::pair<nb::object, std::vector<std::string>>>(opened);
    for (const std::string& text : warnings) tell(MessageKind::warning, text);
    RunRequest request = arguments_of({{"features", "off"}}, "").run;  // creases are for who remeshes
    request.tell = tell;
    request.input.keep_points = asked.keep_points;
    const ReadMemory read = nb::cast<const Source&>(source).read;
    const nb::gil_scoped_release released;
    Input input = read(request, context);
    input.facts.path = asked.path;  // what is in memory has another name
    return input;
  } catch (const nb::python_error& raised) {
    throw error_of(raised);
  }
}

int command(const std::vector<std::string>& arguments, const nb::object& open, const std::string& also_reads) {
  std::vector<const char*> words;
  for (const std::string& word : arguments) words.push_back(word.c_str());
  const tool::ReadOther read_other = [&open](const InputRequest& asked, Context& context, const Tell& tell) {
    return read_by(open, asked, context, tell);
  };
  const nb::gil_scoped_release released;
  return tool::mesh_info_command(int(words.size()), words.data(), read_other, {arguments.at(0), also_reads});
}

}  // namespace

void bind_mesh_info(nb::module_& m) {
  m.def("mesh_info", mesh_info_of, nb::arg("place"), nb::arg("source"), nb::arg("keywords"),
        nb::arg("reference").none(), nb::arg("reference_keywords"), nb::arg("progress").none(), nb::arg("tell"),
        nb::sig("def mesh_info(place: Place, source: Source, keywords: collections.abc.Sequence[tuple[str, str | "
                "None]], reference: Source | None, reference_keywords: collections.abc.Sequence[tuple[str, str | "
                "None]], progress: typing.Any, tell: typing.Any) -> tuple[str, list[str]]"));
  m.def("mesh_info_command", command, nb::arg("arguments"), nb::arg("open"), nb::arg("also_reads"),
        nb::sig("def mesh_info_command(arguments: collections.abc.Sequence[str], open: typing.Any, also_reads: str) -> "
                "int"),
        "The command vdb_meshinfo, as command. open(path) makes a source of a file whose format the library does not "
        "have, with warnings, or returns None. also_reads is a line of the help.");
}

}  // namespace isoshell::python
