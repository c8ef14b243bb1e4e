#include "values/files.h"

#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <utility>
#include <vector>

#include "isoshell/io/output_files.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

using NamedPaths = std::vector<std::pair<std::string, std::string>>;

std::vector<NamedFile> files_of(const NamedPaths& paths) {
  std::vector<NamedFile> files;
  for (const auto& [what, path] : paths) files.push_back({what, path});
  return files;
}

void check(const NamedPaths& outputs, const NamedPaths& inputs, bool overwrite, const std::string& replaces) {
  std::vector<NamedFile> files = files_of(outputs);
  if (!files.empty()) files.front().replaces = replaces;
  check_output_files(files, files_of(inputs), overwrite);
}

}  // namespace

void bind_files(nb::module_& m) {
  m.def("check_output_files", check, nb::arg("outputs"), nb::arg("inputs"), nb::arg("overwrite"),
        nb::arg("replaces") = "",
        "Before any work: what they are and their paths, and which of the inputs the first output may be.");
  m.def("write_text", write_text, nb::arg("path"), nb::arg("text"), nb::arg("overwrite"),
        "A file that appears whole or not at all.");
  m.def("put_in_place", put_in_place, nb::arg("finished"), nb::arg("path"), nb::arg("overwrite"),
        "Give a finished file of the same file system its name, in one step.");
}

}  // namespace isoshell::python
