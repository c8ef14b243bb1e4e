// Mesh files: OBJ, PLY, STL, OFF and glTF in and out. Parallel; no count in a file is trusted.
#pragma once

#include <optional>
#include <string>

#include "isoshell/surface_source.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Reads a mesh. `format` is a name of file_format.h, empty: by the path. `path` "-" reads standard input and needs
/// one. Polygons are split by ear clipping, triangle strips unrolled. Attributes are the numbers of PLY's vertices and
/// faces and its lists of texture coordinates; of OBJ colours behind positions (white where only others have one),
/// texture coordinates, normals, materials, groups and objects; of glTF colours, texture coordinates, normals,
/// materials and scalars whose names begin with _; of text STL the names of solids as groups, where there are two.
/// Other lists are not taken. Integers region_inside and
/// region_outside of PLY's faces are regions, where both differ on every face; such faces are turned where FaceRegions
/// wants it. The meshes of a glTF file stand where its nodes put them, and its up axis stays. Dirty geometry is dropped
/// and counted in the result, a file that lies throws. Throws: unreadable_input (names file and line, element or byte,
/// the value and the remedy), nothing_to_mesh when the file is sound but holds no usable triangle, out_of_memory before
/// reading takes more than `memory_limit_bytes`, if above 0.
TriangleSoup read_mesh(const std::string& path, const std::string& format = "", int64_t memory_limit_bytes = 0);

/// What the numbers of a file make of the positions of a mesh.
struct HeldPositions {
  bool is_single = false;               ///< numbers are 32-bit floats, else of 64 bits
  WorldPoint offset_world = {0, 0, 0};  ///< that was subtracted
  WorldPoint origin_world = {0, 0, 0};  ///< what the numbers are about; the file says it, and readers add it
  double moved_world = 0;               ///< how far rounding moves the farthest vertex, the offset aside
  double shortest_edge_world = 0;       ///< of the mesh
  int64_t lost_triangles = 0;           ///< that tilt by more than 60 degrees or lose their area thereby

  /// So that angles are other ones.
  bool is_coarse() const { return 100 * moved_world > shortest_edge_world; }
};

struct MeshWriteOptions {
  std::string format = {};  ///< a name of file_format.h; empty: by the path
  bool overwrite = false;
  bool curve_edges = false;             ///< also the edges of the mesh's curves: an element edge, in PLY only
  WorldPoint offset_world = {0, 0, 0};  ///< subtracted from what is written; comments of the file say so
  bool may_lose_triangles = false;      ///< also write what HeldPositions::lost_triangles counts
  std::string made_of = {};             ///< of a frame of a sequence: a comment that says of what, in PLY only
  /// What positions_in_file() said of this mesh in this format, with its offset; none: it is found out here.
  std::optional<HeldPositions> held = {};
};
/// Writes a mesh: PLY binary little-endian (double when single precision would move a vertex by more than a
/// thousandth of the shortest edge, else float) with all attributes, OBJ with those that it can hold and faces sorted
/// by material, object and group, binary STL, OFF, glTF in one file with single precision about a node's translation,
/// vertices split where corners differ. Regions are the integers region_inside and region_outside of PLY's faces with
/// comments that name them, a group of OBJ and a primitive of glTF for each pair; STL and OFF have none. Written under
/// a temporary name in the same folder and renamed. `path` "-" writes standard output. Throws: unwritable_output, also
/// where the format's numbers are too coarse for the triangles, or too small, unless that may be; usage for attributes,
/// materials or regions that do not fit the mesh, and for names that PLY cannot hold.
void write_mesh(const std::string& path, const TriangleMesh& mesh, const MeshWriteOptions& options = {});

struct FilePositions {
  HeldPositions held;
  std::vector<WorldPoint> vertices;  ///< as readers have them, without the offset
};

/// Where a file of the format that a mesh less an offset is written to has its vertices. Throws: usage for what is no
/// format of meshes; unwritable_output where a position would not be finite.
FilePositions positions_in_file(const TriangleMesh& mesh, const std::string& format,
                                const WorldPoint& offset_world = {0, 0, 0});

/// What to subtract from a mesh far from the origin: the middle of its box, to whole multiples of a power of ten that
/// is as large as the box; 0 where that is nearer.
WorldPoint offset_to_origin(const TriangleMesh& mesh);

/// What a PLY file says that it was made of, by MeshWriteOptions::made_of; empty where it says nothing. Throws:
/// unreadable_input for what is no PLY file; out_of_memory.
std::string made_of_in_ply(const std::string& path, int64_t memory_limit_bytes = 0);

}  // namespace isoshell
