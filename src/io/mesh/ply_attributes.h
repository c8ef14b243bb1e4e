// Properties of PLY's vertices as attributes, and back.
#pragma once

#include <string>
#include <vector>

#include "io/mesh/ply_header.h"

namespace isoshell {

/// The property of a vertex that is one component of an attribute.
struct PlyColumn {
  int property;
  size_t attribute;
  int32_t component;
};

/// What of the properties beside x, y and z is kept, without values, and what is not.
struct PlyAttributes {
  std::vector<VertexAttribute> attributes;  ///< in the order of their first properties
  std::vector<PlyColumn> columns;           ///< in the order of their properties
  std::vector<DroppedAttribute> dropped;
};

/// Every number is an attribute of its own name. But red, green and blue of one type, and alpha if it is of that type,
/// are the colour, unless another property has its name; lists, normals, texture coordinates and the flag that results
/// have for gaps are dropped.
PlyAttributes find_ply_attributes(const PlyElement& vertices);

/// Names of the properties that hold the attribute's components. Throws: usage when PLY cannot name them.
std::vector<std::string> ply_names(const VertexAttribute& attribute);

}  // namespace isoshell
