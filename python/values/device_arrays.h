// Arrays in the memory of a CUDA device.
#pragma once

#include <nanobind/nanobind.h>

namespace isoshell::python {

/// why_not_readable and copied_from_device.
void bind_device_arrays(nanobind::module_& m);

}  // namespace isoshell::python
