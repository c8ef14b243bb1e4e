// part_options (see part_regions.h).
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"
#include "isoshell/part_regions.h"
#include "pipeline/grid/plan.h"

namespace isoshell {
namespace {

constexpr double kNearSteps = 2;  ///< of the lattice: what is nearer may meet once both are rounded
constexpr double kThinSteps = 8;  ///< where rounding turns walls by 5 degrees and more

}  // namespace

PartOptions part_options(const RemeshOptions& options, const TriangleSoup& soup) {
  InputTopology input;
  for (const auto& [a, b, c] : soup.triangles)
    input.area_world += triangle_area(soup.vertices[a], soup.vertices[b], soup.vertices[c]);
  PartOptions out{options.regions};
  if (input.area_world <= 0) return out;
  const double step_world = plan_of(options, input, bounding_box(soup)).first_voxel_size_world() / kOneVoxelQ8;
  out.near_world = kNearSteps * step_world;
  out.thin_world = kThinSteps * step_world;
  return out;
}

}  // namespace isoshell
