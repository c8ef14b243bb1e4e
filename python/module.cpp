// The compiled part of the package isoshell: what its Python files, which people see, stand on.
#include <nanobind/nanobind.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include "context.h"
#include "errors.h"
#include "keywords.h"
#include "result.h"
#include "run.h"
#include "source.h"
#include "stages.h"
#include "vdb_isomesh/command.h"

namespace nb = nanobind;

namespace {

int command(const std::vector<std::string>& arguments) {
  std::vector<const char*> words;
  for (const std::string& word : arguments) words.push_back(word.c_str());
  return isoshell::tool::command(int(words.size()), words.data());
}

}  // namespace

NB_MODULE(_isoshell, m) {
  using namespace isoshell::python;
  m.attr("VERSION") = ISOSHELL_VERSION;
  bind_errors(m);
  bind_keywords(m);
  bind_source(m);
  bind_context(m);
  bind_result(m);
  bind_run(m);
  bind_stages(m);
  m.def("command", command, nb::arg("arguments"), nb::call_guard<nb::gil_scoped_release>(),
        "The command, with its name as the first argument. Returns its exit status; signals end the process from then "
        "on.");
}
