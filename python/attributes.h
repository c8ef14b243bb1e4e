// Attributes and features of a mesh as arrays.
#pragma once

#include <nanobind/nanobind.h>

#include "isoshell/triangle_mesh.h"

namespace isoshell::python {

/// A list of (name, domain, array, labels), one for each attribute, the gaps among them: rows of vertices or faces, or
/// of faces with three corners each; of the type that the attribute's file had. What it has no value for is NaN, and 0
/// where the type is of whole numbers.
nanobind::list attributes_of(const TriangleMesh& mesh);

/// patch, curve_edges, curve, corners: arrays of int32.
nanobind::dict features_of(const TriangleMesh& mesh);

}  // namespace isoshell::python
