// part_options (see part_regions.h).
#include <algorithm>
#include <sstream>

#include "geometry/box.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "isoshell/part_regions.h"
#include "pipeline/grid/plan.h"

namespace isoshell {
namespace {

constexpr double kNearSteps = 2;       ///< of the lattice: what is nearer may meet once both are rounded
constexpr double kThinSteps = 8;       ///< where rounding turns walls by 5 degrees and more
constexpr double kGapOfEdge = 1. / 8;  ///< edges hide it, and may come to pass through it
constexpr double kMostSnap = .05;      ///< of the longest side: more makes one what nobody takes for near

void check_snap(double snap_world, double longest_world) {
  if (snap_world <= kMostSnap * longest_world) return;
  std::ostringstream text;
  text << "--snap is " << snap_world << "; it may be at most a 20th of the longest side, " << kMostSnap * longest_world;
  throw Error(ErrorCode::usage, "regions", text.str());
}

}  // namespace

PartOptions part_options(const RemeshOptions& options, const TriangleSoup& soup) {
  InputTopology input;
  for (const auto& [a, b, c] : soup.triangles)
    input.area_world += triangle_area(soup.vertices[a], soup.vertices[b], soup.vertices[c]);
  const double snap_world = options.snap_world.value_or(0);
  PartOptions out{options.regions, snap_world, snap_world};
  if (input.area_world <= 0) return out;
  const WorldBox box = bounding_box(soup);
  check_snap(snap_world, longest_side(box));
  const Plan plan = plan_of(options, input, box);
  double finer = 1;  // grids carry the shortest edges
  for (const RegionEdgeLength& length : options.region_edge_lengths)
    finer = std::min(finer, length.edge_length_world / plan.target.edge_length_world);
  const double step_world = finer * plan.first_voxel_size_world() / kOneVoxelQ8;
  out.near_world = std::max(out.near_world, kNearSteps * step_world);
  out.thin_world = std::max(out.thin_world, kThinSteps * step_world);
  out.gap_world = std::max(out.near_world, kGapOfEdge * plan.target.edge_length_world);
  return out;
}

}  // namespace isoshell
