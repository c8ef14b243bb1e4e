// Files that the Python files write.
#pragma once

#include <nanobind/nanobind.h>

namespace isoshell::python {

void bind_files(nanobind::module_& m);

}  // namespace isoshell::python
