// Errors of the library as exceptions of Python.
#pragma once

#include <nanobind/nanobind.h>

#include <string>

namespace isoshell::python {

/// A message that speaks of options as the command has them, with the names of keywords: "--close-gaps" is close_gaps.
std::string in_keywords(const std::string& message);

/// ErrorCode, and the translation of Error to isoshell.Error.
void bind_errors(nanobind::module_& m);

}  // namespace isoshell::python
