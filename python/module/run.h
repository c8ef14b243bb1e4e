// A run, asked for by Python.
#pragma once

#include <nanobind/nanobind.h>

namespace isoshell::python {

void bind_run(nanobind::module_& m);

}  // namespace isoshell::python
