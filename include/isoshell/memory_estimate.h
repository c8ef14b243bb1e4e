// What a run will take, before it allocates anything.
#pragma once

#include <string>

#include "isoshell/remesh.h"

namespace isoshell {

struct RunEstimate {
  int32_t resolution = 0;
  double voxel_size_world = 0;
  int64_t vertices = 0;                  ///< of the result
  int64_t sites = 0, active_voxels = 0;  ///< none where walls between regions are meshed
  int64_t sheet_vertices = 0;            ///< of those walls: of the finer surface that they become
  int64_t vertex_bytes = 0;              ///< of `bytes`, what the vertices of the result take, on any grid
  int64_t bytes = 0;  ///< memory of the library's products and scratch at their peak, the input included
};

/// What needs more than the limit, and which option helps: "the 1,000,000,000 vertices ... need about ...".
std::string over_memory_limit(const RunEstimate& estimate, int64_t limit_bytes);

/// From the area of the surface alone, on the grid the run would start with; `resolution` > 0 overrules the options.
/// Meant to be high rather than low: a plane in the worst direction meets sqrt(3) voxels a voxel of area. Of a surface
/// that parts regions, from the lengths of its edges and those that are asked for.
/// Throws: usage, nothing_to_mesh as choosing the grid does.
RunEstimate estimate_run(const TriangleSoup& soup, const InputTopology& input, const RemeshOptions& options,
                         int32_t resolution = 0);
/// The same, of a soup whose bounding box is known.
RunEstimate estimate_run(const TriangleSoup& soup, const WorldBox& box, const InputTopology& input,
                         const RemeshOptions& options, int32_t resolution = 0);

}  // namespace isoshell
