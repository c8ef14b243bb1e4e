// Results as values that Python can pickle, and back.
#pragma once

#include <nanobind/nanobind.h>

#include "values/result.h"

namespace isoshell::python {

/// Texts, numbers, and bytes in the order of this machine.
nanobind::tuple state_of(const MadeResult& result);

/// Throws: usage for what state_of has not made.
MadeResult result_of_state(const nanobind::tuple& state);

}  // namespace isoshell::python
