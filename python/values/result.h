// The mesh of a run and all that is known of it.
#pragma once

#include <nanobind/nanobind.h>

#include "isoshell/run/run.h"

namespace isoshell::python {

void bind_result(nanobind::module_& m);

}  // namespace isoshell::python
