// See mesh_of_regions.h.
#include "pipeline/regions/mesh_of_regions.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "core/copy_product.h"
#include "core/watched.h"
#include "features/cutting/cut_surface.h"
#include "features/mesh/refine_mesh.h"
#include "features/walls/coarsen_walls.h"
#include "pipeline/defects/inverted_regions.h"
#include "pipeline/grid/attempt.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/grid/timed.h"
#include "pipeline/patches/cut_curves.h"
#include "pipeline/patches/feature_report.h"
#include "pipeline/patches/mend_patches.h"
#include "pipeline/patches/mesh_patches.h"
#include "pipeline/patches/simplify_patches.h"
#include "pipeline/regions/flat_walls.h"
#include "pipeline/regions/region_walls.h"
#include "pipeline/regions/restore_volumes.h"

namespace isoshell {
namespace {

constexpr int64_t kManyVertices = 2;  ///< of walls, for one that is asked for
constexpr const char* kCoarsened =
    "the edges between regions were collapsed, not relaxed, and triangles are less even: ";
constexpr const char* kTooNear = "walls bend, and are nearer to one another than half an edge";

/// Of a mesh whose vertices are no corners of voxels any more.
FaceRegions without_labels(const FaceRegions& regions) {
  FaceRegions out;
  out.background = regions.background;
  out.names = regions.names;
  return out;
}

/// The walls as they came in.
TriangleMesh walls_themselves(const RegionWalls& walls) {
  TriangleMesh mesh;
  mesh.vertices = walls.mesh.vertices;
  mesh.triangles = walls.mesh.triangles;  // each from its smallest corner, and sorted
  const FaceRegions& regions = walls.regions;
  mesh.regions = without_labels(regions);
  mesh.regions.are_of_voxels = regions.are_of_voxels;
  mesh.regions.voxel_size_world = regions.voxel_size_world;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    mesh.regions.labels.push_back(walls.labels_of(t));
    if (!regions.side.empty()) mesh.regions.side.push_back(regions.side[walls.mesh.source_face[t]]);
  }
  return mesh;
}

/// Voxels make far more triangles than are asked for, and those of the fine mesh are more again.
WallTriangles few_triangles_of(const PreparedSurface& p, int64_t vertices) {
  const FeatureMesh& walls = p.walls->mesh;
  if (p.walls->regions.are_of_voxels && int64_t(walls.vertices.size()) > kManyVertices * vertices)
    return {walls.triangles, walls.source_face, walls.vertices.size()};
  return all_triangles_of(*p.cut);
}

bool has_inverted(const CutSurface& cut, const JoinedPatches& joined) {
  return !find_inverted_regions(cut, joined.mesh, joined.features.patch).empty();
}

/// None where triangles intersect, as walls did that came in, or a region is too small for fewer vertices.
std::optional<JoinedPatches> coarsened(const PreparedSurface& p, const PatchOptions& in_patches, RemeshReport& report,
                                       Context& context) {
  report.optimize = {};
  JoinedCheck check(p, *p.cut, context);
  WallMesh walls = timed(report, "coarsen", context, [&] {
    return run_with_threads(context, [&] { return WallMesh(*p.cut, few_triangles_of(p, in_patches.seeds.count)); });
  });
  std::optional<JoinedPatches> made =
      simplify_patches(std::move(walls), in_patches, check, report, report.optimize, context);
  if (made && report.optimize.self_intersections > 0) made.reset();
  if (!made) report.optimize = {};
  return made;
}

TriangleMesh mesh_of(const PreparedSurface& p, const CutSurface& cut, JoinedPatches joined, RemeshReport& report,
                     Context& context) {
  if (p.walls->regions.are_of_voxels)
    timed(report, "volumes", context, [&] { restore_volumes(cut, *p.walls, joined, context); });
  TriangleMesh mesh = to_world(joined.mesh, p.surface.frame);
  mesh.features = std::move(joined.features);
  if (!p.walls->regions.are_of_voxels) put_on_planes(cut, *p.walls, joined.home.view(), mesh, context);
  mesh.regions = without_labels(p.walls->regions);
  const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(cut);
  for (const uint32_t patch : mesh.features.patch) mesh.regions.labels.push_back(labels[patch]);
  if (int64_t(mesh.vertices.size()) > p.target.vertices)
    report.count.why = "the curves between its regions, and walls close together, need them";
  warn_of_left_alone(joined.left_alone, report);
  measure_edges(cut, joined, report.sizing);
  report.features.vertices = joined.on_curves;
  report.features.segments = int64_t(mesh.features.curve_edges.size());
  report.features.kept = report.is_optimized = true;
  return mesh;
}

/// Of relaxed seeds, with cells simplified around faults. Result: why there is none.
std::string join_relaxed(const PreparedSurface& p, SeededMesh& made, const PatchOptions& in_patches,
                         JoinedPatches& joined, RemeshReport& report, Context& context) {
  const CutSurface& cut = *p.cut;
  const JoinOptions options = join_options(in_patches);
  const PatchFaults faults = mesh_patches(p, cut, made, in_patches, report, context);
  if (faults.what.empty()) {
    joined = timed(report, "angles", context, [&] { return widened_to_count(cut, made, options, context); });
    return has_inverted(cut, joined) ? "a region would be inside out" : "";
  }
  std::optional<MendedPatches> mended = mend_patches(p, cut, faults, in_patches, report, context);
  if (!mended) return faults.what;
  joined = accepted(std::move(*mended), report);
  return "";
}

}  // namespace

TriangleMesh triangulate_regions(const PreparedSurface& p, SeededMesh& made, const PatchOptions& in_patches,
                                 RemeshReport& report, Context& context) {
  JoinedPatches joined;
  const std::string why_not = failure_reason([&]() -> std::string {
    if (p.walls->are_too_near) return kTooNear;
    return join_relaxed(p, made, in_patches, joined, report, context);
  });
  if (!why_not.empty()) {
    std::optional<JoinedPatches> coarse = coarsened(p, in_patches, report, context);
    report.warnings.push_back(std::string(coarse ? kCoarsened : "the walls of regions are as they came in: ") +
                              why_not);
    if (!coarse) {
      report.count.why = "the walls of its regions are as they came in";
      return walls_themselves(*p.walls);
    }
    joined = std::move(*coarse);
  }
  return mesh_of(p, *p.cut, std::move(joined), report, context);
}

}  // namespace isoshell
