// Frames one after the other, asked for by Python.
#pragma once

#include <nanobind/nanobind.h>

namespace isoshell::python {

void bind_sequence(nanobind::module_& m);

}  // namespace isoshell::python
