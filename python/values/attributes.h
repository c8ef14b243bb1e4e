// Attributes, features and regions of a mesh as arrays.
#pragma once

#include <nanobind/nanobind.h>

#include <string>
#include <vector>

#include "isoshell/triangle_mesh.h"
#include "values/arrays.h"

namespace isoshell::python {

/// A list of (name, domain, array, labels), one for each attribute, the gaps among them: rows of vertices or faces, or
/// of faces with three corners each; of the type that the attribute's file had. What it has no value for is NaN, and 0
/// where the type is of whole numbers.
nanobind::list attributes_of(const TriangleMesh& mesh);

/// Rows of values as an attribute of the type that the array has. Throws: usage for a type, a domain or a number of
/// components that the name cannot have.
Attribute attribute_of(const std::string& name, const std::string& domain, const AnyArray& rows,
                       std::vector<std::string> labels);

/// patch, curve_edges, curve, corners: arrays of int32.
nanobind::dict features_of(const TriangleMesh& mesh);

/// labels, an array of two int32 a face or of none; background; names by label.
nanobind::dict regions_of(const TriangleMesh& mesh);

}  // namespace isoshell::python
