// See warm_start.h.
#include "pipeline/sheet/warm_start.h"

#include <algorithm>

#include "geometry/world_vector.h"
#include "measure/triangle_shape.h"
#include "pipeline/sheet/hierarchy.h"

namespace isoshell {
namespace {

constexpr int32_t kWarmSmoothingSteps = 24;
constexpr int64_t kMostGrowth = 2;    ///< or shrinking of the number of vertices from frame to frame
constexpr double kMostSpoiled = 0.1;  ///< of the triangles
constexpr size_t kMostLookedAt = 4096;

SeedSet seeds_at(const std::vector<WorldPoint>& points, const LatticeFrame& frame) {
  const auto count = int64_t(points.size());
  SeedSet seeds;
  seeds.position = Buffer<PointQ8>(count);
  seeds.normal = Buffer<Normal8>(count);
  seeds.home = Buffer<uint32_t>(count);
  std::fill(seeds.normal.begin(), seeds.normal.end(), Normal8{0, 0, 0});
  std::fill(seeds.home.begin(), seeds.home.end(), uint32_t(0));
  for (int64_t i = 0; i < count; ++i) seeds.position[i] = frame.snap(points[size_t(i)]);
  return seeds;
}

/// What edges are the longest is told by where the vertices are now.
SeedSet with_more(const Sheet& sheet, const PreviousFrame& previous, SeedSet seeds, int64_t wanted, Context& context) {
  DualMesh mesh;
  mesh.position = seeds.position.to_host();
  mesh.triangles = Buffer<TriangleIndices>(int64_t(previous.triangles.size()));
  for (size_t t = 0; t < previous.triangles.size(); ++t) {
    const auto& corners = previous.triangles[t];
    mesh.triangles[int64_t(t)] = {corners[0], corners[1], corners[2]};
  }
  return subdivide_seeds(sheet, mesh, seeds, wanted, context);
}

double quality_in(const std::vector<WorldPoint>& at, const std::array<uint32_t, 3>& t) {
  const WorldPoint &a = at[t[0]], &b = at[t[1]], &c = at[t[2]];
  const double edge[3] = {length(b - a), length(c - b), length(a - c)};
  return triangle_quality(length(doubled_area(a, b, c)), edge[0] + edge[1] + edge[2],
                          *std::max_element(edge, edge + 3));
}

/// The share of triangles that are less than half as good where their vertices are now, of some thousand.
double share_spoiled(const PreviousFrame& previous) {
  const size_t step = previous.triangles.size() / kMostLookedAt + 1;
  int64_t spoiled = 0, looked_at = 0;
  for (size_t t = 0; t < previous.triangles.size(); t += step, ++looked_at)
    spoiled +=
        2 * quality_in(previous.carried, previous.triangles[t]) < quality_in(previous.vertices, previous.triangles[t]);
  return double(spoiled) / double(std::max<int64_t>(1, looked_at));
}

/// Why a frame that wants so many vertices cannot begin with those of the frame before; empty where it can.
std::string reason_to_begin_cold(const PreviousFrame& previous, int64_t wanted) {
  const auto before = int64_t(previous.vertices.size());
  if (before == 0 || previous.carried.size() != previous.vertices.size()) return "there are no vertices before it";
  if (before > kMostGrowth * wanted || wanted > kMostGrowth * before)
    return "the frame before has " + std::to_string(before) + " vertices, and this one is to have " +
           std::to_string(wanted);
  if (share_spoiled(previous) > kMostSpoiled)
    return "the vertices of the frame before do not lie on this one as they did: its surface is another, or far away";
  return "";
}

}  // namespace

std::string choose_beginning(PreparedSurface& p) {
  const std::shared_ptr<const PreviousFrame>& before = p.options.previous;
  if (!before) return "";
  std::string why_cold = reason_to_begin_cold(*before, p.target.vertices);
  if (why_cold.empty()) p.previous = before;
  return why_cold;
}

RelaxedSeeds relax_from_previous(const Sheet& sheet, const PreviousFrame& previous, int64_t wanted,
                                 const RelaxOptions& options, bool tolerance_requested, Context& context) {
  SeedSet seeds = attach_to_sheet(sheet, seeds_at(previous.carried, sheet.frame), 0, context);
  if (seeds.size() < wanted) seeds = with_more(sheet, previous, std::move(seeds), wanted, context);
  const RelaxOptions finest = for_finest_level(options, tolerance_requested, finest_tolerance_ppb(sheet));
  return relax_on_sheet(sheet, std::move(seeds), finest, context);
}

OptimizeOptions for_warm_frame(OptimizeOptions options) {
  options.smoothing_steps = kWarmSmoothingSteps;
  return options;
}

}  // namespace isoshell
