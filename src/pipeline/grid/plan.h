// What a run aims at and the grid that it starts with: resolved once from what was asked for, before anything is made.
#pragma once

#include "isoshell/remesh_options.h"

namespace isoshell {

constexpr int32_t kMinDefaultResolution = 64;  ///< of a grid that nobody asked for

/// How many vertices a result has, and how long edges are where nothing else says it.
struct Target {
  int64_t vertices = 0;
  double edge_length_world = 0;
};

/// What the options ask of a surface of this area: a count, or an edge length, and the other follows. Throws: usage
/// when an edge length asks for more than 2^31 - 1 vertices.
Target target_of(const RemeshOptions& options, double area_world);
/// Of so many vertices.
Target target_of(int64_t vertices, double area_world);
/// So many vertices have edges of this length. Throws: as target_of.
int64_t vertices_of_edge(double edge_world, double area_world);

/// Area of a sheet in world units.
double sheet_area_world(const Sheet& sheet);

/// So many voxels along the longest side that cells of this width are 4.5 to 5.5 voxels wide, by how many vertices
/// there are, within limits.
int32_t resolution_for_cell(double longest_world, double cell_world, int64_t vertices);

/// A run on a surface, before its grid.
struct Plan {
  RemeshOptions options;  ///< as checked(), and with a sizing field that has one length alone as an edge length
  InputTopology input;
  WorldBox box;
  Target target;  ///< for the area of the input

  /// Voxels along the longest side that the run starts with: the user's, or so many that a cell is 4.5 to 5.5 voxels
  /// wide. Throws: usage when a voxel size does not give 8 to 8192.
  int32_t first_resolution() const;
  /// Of so many voxels along the longest side; of exactly the size that the options name, where that gives as many.
  LatticeFrame frame(int32_t resolution) const;
  double first_voxel_size_world() const { return frame(first_resolution()).voxel_size; }
  bool chooses_grid() const { return !options.resolution && !options.voxel_size_world; }
};

/// Throws: usage, as target_of, and where an edge length asks for fewer than 4 vertices on an area like the input's.
Plan plan_of(const RemeshOptions& checked_options, const InputTopology& input, const WorldBox& box);

/// How the options relax whatever is relaxed.
RelaxOptions relax_options(const RemeshOptions& options);
/// How they improve a mesh.
OptimizeOptions optimize_options(const RemeshOptions& options);

}  // namespace isoshell
