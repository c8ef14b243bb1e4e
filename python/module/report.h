// What the page of a report is made from, and the command, which may ask for one.
#pragma once

#include <nanobind/nanobind.h>

namespace isoshell::python {

void bind_report(nanobind::module_& m);

}  // namespace isoshell::python
