#include "values/keywords.h"

#include <nanobind/stl/tuple.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <tuple>
#include <vector>

#include "isoshell/io/file_format.h"
#include "isoshell/io/python_formats.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {

namespace {

std::vector<std::string> names_of(bool (*is_one)(const FileFormat&)) {
  std::vector<std::string> names;
  for (const FileFormat& format : file_formats())
    if (is_one(format)) names.push_back(format.name);
  return names;
}

}  // namespace

tool::Arguments arguments_of(const Keywords& keywords, const std::string& output) {
  std::vector<tool::GivenOption> given;
  for (const auto& [name, value] : keywords) given.push_back({name, value});
  return tool::parse_given_options(given, output);
}

void bind_keywords(nb::module_& m) {
  nb::class_<tool::OptionEntry>(m, "OptionEntry", "An option of the command.")
      .def_ro("group", &tool::OptionEntry::group)
      .def_ro("name", &tool::OptionEntry::name, "Without dashes.")
      .def_ro("value", &tool::OptionEntry::value, "What stands for its value, as K; empty for a flag.")
      .def_ro("text", &tool::OptionEntry::text)
      .def_ro("fallback", &tool::OptionEntry::fallback, "What holds without it.")
      .def_ro("real", &tool::OptionEntry::real, "Takes any number, not only whole ones.")
      .def_ro("of_command", &tool::OptionEntry::of_command, "No keyword: only the command has it.")
      .def_ro("repeats", &tool::OptionEntry::repeats, "Its text has a line for each time that it is given.")
      .def_prop_ro(
          "low", [](const tool::OptionEntry& o) { return o.range.low; }, "The least number that it takes.")
      .def_prop_ro(
          "high", [](const tool::OptionEntry& o) { return o.range.high; }, "The largest number that it takes.");
  m.def(
      "mesh_formats", [] { return names_of(writes_mesh); }, "Of files that meshes are written to.");
  m.def(
      "input_formats", [] { return names_of(reads_anything); }, "Of files that are read: meshes, points and volumes.");
  m.def(
      "python_formats",
      [] {
        std::vector<std::tuple<std::string, std::string, bool, bool>> all;
        for (const PythonFormat& f : python_formats()) all.emplace_back(f.name, f.extra, f.reads, f.writes);
        return all;
      },
      "Of files that this package reads or writes by others: ending, extra, whether it reads, whether it writes.");
  m.def("option_table", tool::option_table, "Every option of the command.");
}

}  // namespace isoshell::python
