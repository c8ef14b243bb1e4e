// estimate_run (see isoshell/memory_estimate.h).
#include "isoshell/repair.h"
#include "options/check_options.h"
#include "pipeline/grid/memory_estimate.h"
#include "pipeline/regions/region_lengths.h"
#include "pipeline/regions/region_memory.h"

namespace isoshell {

RunEstimate estimate_run(const TriangleSoup& soup, const InputTopology& input, const RemeshOptions& options,
                         int32_t resolution) {
  return estimate_run(soup, bounding_box(soup), input, options, resolution);
}

RunEstimate estimate_run(const TriangleSoup& soup, const WorldBox& box, const InputTopology& input,
                         const RemeshOptions& options, int32_t resolution) {
  Context context;
  if (const std::optional<TriangleSoup> pulled = pull_back_far_vertices(soup, options, context))
    return estimate_run(*pulled, measure_topology(*pulled, context).topology, options, resolution);
  const Plan plan = plan_of(checked(options), input, box);
  if (soup.regions.empty()) return estimate_plan(plan, soup, resolution);
  const std::vector<double> of_face_world = lengths_of_faces_world(soup.regions, plan.options.region_edge_lengths);
  return estimate_walls(plan, soup, of_face_world,
                        resolution > 0 ? plan.frame(resolution) : frame_of_walls(soup, plan, of_face_world));
}

}  // namespace isoshell
