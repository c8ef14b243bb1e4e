// What of an attribute belongs to what of a mesh.
#pragma once

#include <cmath>

#include "isoshell/attribute.h"

namespace isoshell {

/// What is wrong where values or indices are not as many as the attribute's domain has elements, or an index or a
/// number of a label is out of range; empty where nothing is.
std::string misfit_of(const Attribute& attribute, size_t vertices, size_t triangles);

/// The meaning that the attribute has by its name and number of components, whatever has the values; null for none.
const AttributeMeaning* fitting_meaning(const Attribute& attribute);

/// The first of the components of a vertex, corner or face.
inline const double* value_of(const Attribute& a, size_t element) {
  return &a.values[(a.index.empty() ? element : a.index[element]) * size_t(a.components)];
}

/// Whether two values are the same number, or both none.
inline bool is_same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }
inline bool is_same(const double* a, const double* b, int32_t components) {
  for (int32_t i = 0; i < components; ++i)
    if (!is_same(a[i], b[i])) return false;
  return true;
}

}  // namespace isoshell
