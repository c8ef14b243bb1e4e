// Many runs side by side, asked for by Python.
#pragma once

#include <nanobind/nanobind.h>

namespace isoshell::python {

void bind_many(nanobind::module_& m);

}  // namespace isoshell::python
