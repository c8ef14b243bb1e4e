// What a run on walls between regions will take.
#pragma once

#include <cstdint>
#include <vector>

#include "isoshell/memory_estimate.h"
#include "pipeline/grid/plan.h"

namespace isoshell {

/// Whether walls of voxels have so many more vertices than a result, as long as its edges are about as long everywhere,
/// that most go before they are cut: four edges for one.
inline bool are_thinned_out(const TriangleSoup& walls, int64_t vertices) {
  return walls.regions.are_of_voxels && int64_t(walls.vertices.size()) > 16 * vertices;
}

/// As estimate_run: from how finely walls are cut (see refine_mesh), and of those of voxels what making them took.
/// `of_face_world` as lengths_of_faces_world() gives it. Cost: O(triangles).
RunEstimate estimate_walls(const Plan& plan, const TriangleSoup& walls, const std::vector<double>& of_face_world,
                           const LatticeFrame& frame);

/// Throws: out_of_memory where the estimate is above the limit.
void require_memory_for_walls(const RunEstimate& estimate, const Context& context);

}  // namespace isoshell
