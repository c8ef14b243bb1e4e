// See warm_patches.h.
#include "pipeline/patches/warm_patches.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "attributes/facing_point.h"
#include "core/parallel_ranges.h"
#include "core/vector_view.h"
#include "core/watched.h"
#include "features/cutting/curve_seeds.h"
#include "features/cutting/free_seeds.h"
#include "features/seeds/carried_positions.h"
#include "geometry/outward_normals.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"
#include "pipeline/sheet/hierarchy.h"

namespace isoshell {
namespace {

/// Ends after six to eight passes where the surface moves little: every pass undoes some of what was repaired beside
/// curves.
constexpr int32_t kWarmTolerancePpb = 2000000;

/// Of the corners of a triangle that are off curves the one whose part of a place is the largest; kNone where all are
/// on curves.
uint32_t corner_inside(const CutSurface& cut, const std::array<uint32_t, 3>& corner, const MeshPoint& place) {
  const double part[3] = {1 - place.b_part - place.c_part, place.b_part, place.c_part};
  uint32_t found = kNone;
  double most = -1;
  for (size_t i = 0; i < 3; ++i)
    if (cut.place[corner[i]] == kNone && part[i] > most) most = part[i], found = corner[i];
  return found;
}

/// The vertices of the frame before on a cut surface: kNone for those on curves, else a near vertex of their patch.
std::vector<uint32_t> homes_inside(const CutSurface& cut, const PreviousFrame& previous) {
  const SurfaceMesh& surface = cut.surface;
  std::vector<WorldPoint> points(size_t(surface.vertex_count())), carried_q8(previous.carried.size());
  for_each_index(size_t(0), points.size(),
                 [&](size_t v) { points[v] = cut.frame.to_world(surface.position[int64_t(v)]); });
  for_each_index(size_t(0), carried_q8.size(), [&](size_t i) {
    const PointQ8 p = cut.frame.snap(previous.carried[i]);
    carried_q8[i] = {double(p.x), double(p.y), double(p.z)};
  });
  const TriangleGrid::Triangles triangles = list_of(surface.triangles.view());
  const TriangleGrid grid(points, triangles);
  const std::vector<PositionOnPath> on_paths = positions_on_paths(*cut.fine, carried_q8);
  const std::vector<WorldPoint> normals = outward_normals(previous.carried, previous.triangles);
  const double edge_length_world = cut.longest_edge_q8 / kOneVoxelQ8 * cut.frame.voxel_size;
  std::vector<uint32_t> home(previous.carried.size(), kNone);
  for_each_index(size_t(0), home.size(), [&](size_t i) {
    if (on_paths[i].path != PositionOnPath::kNoPath) return;
    const MeshPoint place = facing_point(grid, previous.carried[i], normals[i], edge_length_world);
    home[i] = corner_inside(cut, triangles[place.triangle], place);
  });
  return home;
}

/// Per vertex the square of the shortest edge at it.
std::vector<double> shortest_edges(const PreviousFrame& previous) {
  std::vector<double> shortest(previous.carried.size(), std::numeric_limits<double>::infinity());
  for (const auto& t : previous.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = t[i], b = t[(i + 1) % 3];
      const double d = distance_sq(previous.carried[a], previous.carried[b]);
      shortest[a] = std::min(shortest[a], d);
      shortest[b] = std::min(shortest[b], d);
    }
  return shortest;
}

/// Those inside as seeds, with their triangles, the ones with the longest edges first, beside the lengths aimed at. Of
/// those with one home the first.
SeededMesh seeds_inside(const CutSurface& cut, const PreviousFrame& previous, const std::vector<uint32_t>& home) {
  std::vector<uint32_t> order;
  for (uint32_t i = 0; i < home.size(); ++i)
    if (home[i] != kNone) order.push_back(i);
  std::vector<double> shortest = shortest_edges(previous);
  if (const EdgeLengths& lengths = cut.surface.lengths; !lengths.at.empty())
    for (const uint32_t i : order) shortest[i] /= double(lengths.at[home[i]]) * double(lengths.at[home[i]]);
  std::stable_sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return shortest[a] > shortest[b]; });
  std::vector<char> is_taken(size_t(cut.surface.vertex_count()), 0);
  order.erase(std::remove_if(order.begin(), order.end(),
                             [&](uint32_t i) { return std::exchange(is_taken[home[i]], char(1)) != 0; }),
              order.end());
  SeededMesh inside;
  const auto count = int64_t(order.size());
  inside.seeds.position = Buffer<PointQ8>(count);
  inside.seeds.normal = Buffer<Normal8>(count);
  inside.seeds.home = Buffer<uint32_t>(count);
  std::vector<uint32_t> seed_of(home.size(), kNone);
  for (int64_t s = 0; s < count; ++s) {
    const uint32_t i = order[size_t(s)];
    seed_of[i] = uint32_t(s);
    inside.seeds.position[s] = cut.frame.snap(previous.carried[i]);
    inside.seeds.home[s] = home[i];
    inside.seeds.normal[s] = cut.surface.normal[home[i]];
  }
  std::vector<TriangleIndices> triangles;
  for (const auto& t : previous.triangles) {
    const TriangleIndices of{seed_of[t[0]], seed_of[t[1]], seed_of[t[2]]};
    if (of.a != kNone && of.b != kNone && of.c != kNone) triangles.push_back(of);
  }
  inside.mesh.triangles = buffer_of(triangles);
  return inside;
}

}  // namespace

RelaxedSeeds relax_patches_from_previous(const CutSurface& cut, const PatchOptions& options, Context& context) {
  const SeededMesh inside = seeds_inside(
      cut, *options.previous, run_with_threads(context, [&] { return homes_inside(cut, *options.previous); }));
  const FreeSeeds free_seeds(cut);
  SeedSet fixed = seeds_on_curves(cut, 0);
  FreeSeeds::Counts before(patch_count(cut), 0);
  for (const uint32_t v : inside.seeds.home) ++before[cut.surface.patch[v]];
  const FreeSeeds::Counts counts = free_seeds.as_before(free_seeds.counts(fixed, options.seeds.count), before);
  const RelaxOptions relax = for_finest_level(options.relax, options.tolerance_requested, kWarmTolerancePpb);
  return relax_on_sheet(cut.surface, free_seeds.add_finer(std::move(fixed), counts, inside, options.seeds.seed), relax,
                        context);
}

}  // namespace isoshell
