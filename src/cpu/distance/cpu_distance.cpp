// The CPU's sum_distances.
#include "core/vector_view.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "stages/distance/distance_body.h"

namespace isoshell {

DistanceSums CpuBackend::sum_distances(const TriangleMesh& from, const std::vector<double>& area_until,
                                       const TriangleGridView& to, const DistancePlaces& places,
                                       Context& context) const {
  CpuExecutor exec(context, "distance");
  return run_with_threads(context, [&] {
    return sum_distances_body(exec, {view_of(from.vertices), view_of(from.triangles), view_of(area_until)}, to, places);
  });
}

}  // namespace isoshell
