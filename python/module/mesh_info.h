// The certificate of a mesh, asked for by Python.
#pragma once

#include <nanobind/nanobind.h>

namespace isoshell::python {

void bind_mesh_info(nanobind::module_& m);

}  // namespace isoshell::python
