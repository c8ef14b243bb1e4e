// What tells unsigned distances from densities and other values: how steep they are.

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/parallel_ranges.h"
#include "implicit/volumes/unsigned_field.h"

namespace isoshell {
namespace {

constexpr double kSlopeSlack = 0.25;  // of a voxel a voxel
constexpr double kLeastSteep = 0.6;   // of the values looked at: on ridges and near edges distances are not as steep

struct Steepness {
  int64_t values = 0, steep = 0, near = 0;
};

/// How many values above `voxel` and inside of the band rise by it a voxel, away from the lower of their neighbours.
Steepness steepness(const ScalarField& field, double voxel) {
  const std::vector<Voxel> blocks = field.blocks();
  const double full = field.background > 0 ? kFullPart * field.background : INFINITY;
  std::vector<Steepness> of_block(blocks.size());
  for_each_index(size_t(0), blocks.size(), [&](size_t b) {
    float window[kWindow * kWindow * kWindow];
    const int all[3] = {kFieldBlock, kFieldBlock, kFieldBlock};
    field.copy(blocks[b], all, window);
    for (int x = 0; x < kFieldBlock; ++x)
      for (int y = 0; y < kFieldBlock; ++y)
        for (int z = 0; z < kFieldBlock; ++z) {
          const float* at = window + x * kWindowStride[0] + y * kWindowStride[1] + z;
          of_block[b].near += *at < voxel;
          if (std::min({x, y, z}) == 0 || std::max({x, y, z}) == kFieldBlock - 1) continue;
          if (!(*at > voxel && *at < full)) continue;
          double slope_sq = 0;
          for (const int stride : kWindowStride) {
            const double rise = std::max(0.0, double(*at) - std::min(at[stride], at[-stride]));
            slope_sq += rise * rise;
          }
          ++of_block[b].values;
          of_block[b].steep += std::abs(std::sqrt(slope_sq) / voxel - 1) <= kSlopeSlack;
        }
  });
  Steepness sum;
  for (const Steepness& s : of_block) sum.values += s.values, sum.steep += s.steep, sum.near += s.near;
  return sum;
}

}  // namespace

DistanceKind kind_of_distance(const ScalarField& field) {
  const double edge = cube_edge(field.to_world);
  if (edge == 0) return {0, "its voxels are no cubes; resample it"};
  std::ostringstream why;
  for (const double voxel : {edge, 1.0}) {
    const Steepness found = steepness(field, voxel);
    if (found.values > 0 && double(found.steep) >= kLeastSteep * double(found.values)) {
      if (found.near > 0) return {voxel, ""};
      return {0, "its smallest value is more than a voxel"};
    }
    why << (why.str().empty() ? "" : ", and ");
    if (found.values == 0)
      why << "no value inside of it lies between " << voxel << " and its background";
    else
      why << "only " << std::lround(100.0 * double(found.steep) / double(found.values)) << " % of its values above "
          << voxel << " rise by that a voxel";
    if (edge == 1) break;
  }
  return {0, why.str()};
}

}  // namespace isoshell
