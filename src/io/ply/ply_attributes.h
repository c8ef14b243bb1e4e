// Properties of PLY's vertices as attributes, and back.
#pragma once

#include <string>
#include <vector>

#include "io/ply/ply_header.h"

namespace isoshell {

/// The property of a vertex that is one component of an attribute.
struct PlyColumn {
  int property;
  size_t attribute;
  int32_t component;
};

/// The property of a face that lists the values of its corners, `components` of them each.
struct PlyCornerList {
  int property;
  size_t attribute;
  int32_t components;
};

/// What of the properties beside positions and corners is kept, without values, and what is not.
struct PlyAttributes {
  std::vector<Attribute> attributes;  ///< in the order of their first properties
  std::vector<PlyColumn> columns;     ///< in the order of their properties
  std::vector<PlyCornerList> lists;   ///< likewise, of faces
  std::vector<DroppedAttribute> dropped;
};

/// Every number is an attribute of its own name. But red, green and blue of one type, and alpha if it is of that type,
/// are the colour, unless another property has its name; so are nx, ny and nz the normal, and u and v, s and t,
/// texture_u and texture_v or texture_s and texture_t the texture coordinates. Lists, and the flag that results have
/// for gaps, are dropped.
PlyAttributes find_ply_attributes(const PlyElement& vertices);

/// The same of faces: numbers, the list texcoord, which is texture coordinates of corners, and a list of normals.
/// Labels are those of the header's notes.
PlyAttributes find_face_attributes(const PlyHeader& header, const PlyElement& faces);

/// Names of files in the header's notes.
AttributeFiles find_files(const PlyHeader& header);

/// Names of the properties that hold the attribute's components. Throws: usage when PLY cannot name them.
std::vector<std::string> ply_names(const Attribute& attribute);

/// Name of the list of a face that holds the values of an attribute of corners. Throws: usage as ply_names.
std::string ply_list_name(const Attribute& attribute);

}  // namespace isoshell
