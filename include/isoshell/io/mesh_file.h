// Mesh files: OBJ, PLY, STL, OFF and glTF in and out. Parallel, memory-mapped; no count in a file is trusted.
#pragma once

#include <string>

#include "isoshell/surface_source.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Reads a mesh. `format` is a name of file_format.h, empty: by the path. `path` "-" reads standard input and needs
/// one. Polygons are split by ear clipping, triangle strips unrolled. Attributes are the numbers of PLY's vertices and
/// faces and its lists of texture coordinates; of OBJ colours behind positions (white where only others have one),
/// texture coordinates, normals, materials, groups and objects; of glTF colours, texture coordinates, normals,
/// materials and scalars whose names begin with _. Other lists are not taken. Integers region_inside and
/// region_outside of PLY's faces are regions, where both differ on every face; such faces are turned where FaceRegions
/// wants it. The meshes of a glTF file stand where its nodes put them, and its up axis stays. Dirty geometry is dropped
/// and counted in the result, a file that lies throws. Throws: unreadable_input (names file and line, element or byte,
/// the value and the remedy), nothing_to_mesh when the file is sound but holds no usable triangle.
TriangleSoup read_mesh(const std::string& path, const std::string& format = "");

struct MeshWriteOptions {
  std::string format = {};  ///< a name of file_format.h; empty: by the path
  bool overwrite = false;
  bool curve_edges = false;  ///< also the edges of the mesh's curves: an element edge, in PLY only
};
/// Writes a mesh: PLY binary little-endian (double when single precision would move a vertex by more than a
/// thousandth of the shortest edge, else float) with all attributes, OBJ with those that it can hold and faces sorted
/// by material, object and group, binary STL, OFF, glTF in one file with single precision about a node's translation,
/// vertices split where corners differ. Regions are the integers region_inside and region_outside of PLY's faces with
/// comments that name them, a group of OBJ and a primitive of glTF for each pair; STL and OFF have none. Written under
/// a temporary name in the same folder and renamed. `path` "-" writes standard output. Throws: unwritable_output; usage
/// for attributes, materials or regions that do not fit the mesh, and for names that PLY cannot hold.
void write_mesh(const std::string& path, const TriangleMesh& mesh, const MeshWriteOptions& options = {});

/// Puts the vertices where a PLY file of the mesh has them.
void round_as_in_ply(TriangleMesh& mesh);

}  // namespace isoshell
