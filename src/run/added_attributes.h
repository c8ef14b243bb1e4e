// What the vertices of a result have that its surface does not give them.
#pragma once

#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/message.h"
#include "isoshell/previous_frame.h"
#include "isoshell/run/record.h"

namespace isoshell {

/// Gives the mesh the vertex attributes `born`, 1 where a vertex is not the one of its number in the frame before, and
/// vx, vy and vz, its motion since then in world units, 0 where it was born; in place of the input's of these names.
void add_motion_attributes(const PreviousFrame& previous, TriangleMesh& mesh);

/// Reads the grids of files of their own among those that are asked for, behind those of the input's file, and adds
/// those in memory. Throws: usage for one of the input's where that has none, and for two of one name; as
/// read_grid_fields() does.
void read_other_grids(const InputRequest& request, Input& input, const Context& context);

/// Gives the vertices what the input's grids have where they are: numbers under a grid's name, three numbers as NAME.0,
/// NAME.1 and NAME.2, or as the colour where real ones are called Cd or color; in place of other attributes of these
/// names. Warns of a grid that files of `format` do not hold, and of one without an active voxel at any vertex.
void add_grid_attributes(const Input& input, const std::string& format, TriangleMesh& mesh, AttributeReport& report,
                         const Tell& tell);

}  // namespace isoshell
