// Which grid a run starts with.
#pragma once

#include "isoshell/remesh.h"

namespace isoshell {

/// Target count of a surface of this area. Throws: usage when an edge length asks for more than 2^31 - 1.
int64_t vertex_target(const RemeshOptions& options, double area_world);

/// Target count of a prepared run, whose field may decide it.
int64_t vertex_target(const RemeshOptions& options, const Prepared& prepared);

/// Edge length where nothing else says one: that of the options, or of as many vertices as they ask for.
double usual_edge_length(const RemeshOptions& options, double area_world);

/// The mean edge length of a prepared run, whose field may decide it.
double usual_edge_length(const RemeshOptions& options, const Prepared& prepared);

/// Area of a sheet in world units.
double sheet_area_world(const Sheet& sheet);

/// So many voxels along the longest side that cells of this width are 4.5 to 5.5 voxels wide, by how many vertices
/// there are, within limits.
int32_t resolution_for_cell(double longest_world, double cell_world, int64_t vertices);

/// Voxels along the longest side of the box: the user's, or so many that a cell is 4.5 to 5.5 voxels wide.
/// Throws: usage when a voxel size does not give 8 to 8192.
int32_t first_resolution(const RemeshOptions& options, double area_world, WorldPoint box_min, WorldPoint box_max);

}  // namespace isoshell
