// Errors of the library as exceptions of Python.
#pragma once

#include <nanobind/nanobind.h>

#include <exception>
#include <new>
#include <string>

#include "isoshell/error.h"

namespace isoshell::python {

/// A message that speaks of options as the command has them, with the names of keywords: "--close-gaps" is close_gaps.
std::string in_keywords(const std::string& message);

/// What Python has raised, as an Error: an isoshell.Error with its code and stage, another exception as internal. Needs
/// the interpreter's lock.
Error error_of(const nanobind::python_error& raised);

/// ErrorCode, and the translation of Error to isoshell.Error.
void bind_errors(nanobind::module_& m);

/// Calls work(); what it throws is an Error or std::bad_alloc.
template <class Work>
auto with_errors(Work work) {
  try {
    return work();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& e) {
    throw Error(ErrorCode::internal, "run", e.what());
  }
}

}  // namespace isoshell::python
