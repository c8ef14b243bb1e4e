// The stages of a run one by one.
#pragma once

#include <nanobind/nanobind.h>

namespace isoshell::python {

void bind_stages(nanobind::module_& m);

}  // namespace isoshell::python
