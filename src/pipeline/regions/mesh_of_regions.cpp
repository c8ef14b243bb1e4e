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
#include "features/walls/periodic_sides.h"
#include "features/walls/side_places.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"
#include "pipeline/defects/inverted_regions.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/patches/feature_report.h"
#include "pipeline/patches/mend_patches.h"
#include "pipeline/patches/simplify_patches.h"
#include "pipeline/regions/flat_walls.h"
#include "pipeline/regions/open_wedges.h"
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

MeshedPatches join_relaxed(const PreparedSurface& p, SeededMesh& made, const PatchOptions& in_patches, Run& run) {
  MeshedPatches walls;
  if (p.walls->are_too_near)
    walls.why_not = kTooNear;
  else
    walls = join_patches(p, *p.cut, made, in_patches, run);
  if (walls.why_not.empty() && !find_inverted_regions(*p.cut, walls.joined.mesh, walls.joined.features.patch).empty())
    walls.why_not = "a region would be inside out";
  return walls;
}

/// Joins them from coarsened walls. False where triangles intersect, as walls did that came in, or a region is too
/// small for fewer vertices.
bool coarsen(const PreparedSurface& p, const PatchOptions& in_patches, MeshedPatches& walls, Run& run) {
  walls.optimize = {};
  JoinedCheck check(p, *p.cut, run.context);
  WallMesh fine = run.timed("coarsen", [&] {
    return run_with_threads(run.context, [&] { return WallMesh(*p.cut, few_triangles_of(p, in_patches.seeds.count)); });
  });
  std::optional<JoinedPatches> made = simplify_patches(std::move(fine), in_patches, check, walls.optimize, run);
  const bool is_made = made && walls.optimize.self_intersections == 0;
  if (is_made) walls.joined = std::move(*made);
  if (!is_made) walls.optimize = {};
  return is_made;
}

/// Such triangles are on one of two opposite sides alone.
void warn_of_walls_in_sides(const CutSurface& cut, const JoinedPatches& joined, Run& run) {
  if (!has_periodic_sides(cut)) return;
  const PeriodicSides sides(cut);
  int64_t count = 0;
  WorldPoint first{0, 0, 0};
  for (int64_t t = 0; t < joined.mesh.triangles.size(); ++t) {
    if (sides.of_patch(joined.features.patch[size_t(t)]) > 0) continue;
    const auto& [a, b, c] = joined.mesh.triangles[t];
    const auto at_q8 = [&](uint32_t v) -> WorldPoint {
      const PointQ8& p = joined.mesh.position[v];
      return {double(p.x), double(p.y), double(p.z)};
    };
    if (!sides.hold({at_q8(a), at_q8(b), at_q8(c)})) continue;
    if (count++ == 0) first = cut.frame.to_world(joined.mesh.position[a]);
  }
  if (count > 0)
    run.warn(counted(count, "triangle of a wall lies", "triangles of walls lie") +
             " in a periodic side, the first near " + readable_place(first, cut.frame) +
             ": the opposite side has none there");
}

TriangleMesh mesh_of(const PreparedSurface& p, JoinedPatches& joined, Run& run) {
  const CutSurface& cut = *p.cut;
  if (p.walls->regions.are_of_voxels)
    run.timed("volumes", [&] {
      open_wedges(*p.walls, cut, joined, run.context);
      restore_volumes(cut, *p.walls, joined, run.context);
      open_wedges(*p.walls, cut, joined, run.context);  // what closed again, by little
    });
  warn_of_walls_in_sides(cut, joined, run);
  TriangleMesh mesh = to_world(joined.mesh, p.surface.frame);
  mesh.features = std::move(joined.features);
  if (!p.walls->regions.are_of_voxels) put_on_planes(cut, *p.walls, joined.home.view(), mesh, run.context);
  mesh.regions = without_labels(p.walls->regions);
  const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(cut);
  for (const uint32_t patch : mesh.features.patch) mesh.regions.labels.push_back(labels[patch]);
  return mesh;
}

}  // namespace

TriangleMesh triangulate_regions(const PreparedSurface& p, SeededMesh& made, const PatchOptions& in_patches,
                                 RemeshReport& report, Run& run) {
  MeshedPatches walls = join_relaxed(p, made, in_patches, run);
  const bool is_relaxed = walls.why_not.empty(), is_made = is_relaxed || coarsen(p, in_patches, walls, run);
  if (!is_relaxed) run.warn((is_made ? kCoarsened : "the walls of regions are as they came in: ") + walls.why_not);
  report.dual = walls.dual;
  report.optimize = walls.optimize;
  if (!is_made && p.walls->regions.is_periodic())
    throw Error(ErrorCode::usage, "regions",
                "--periodic: opposite sides cannot get the same triangles, as " + walls.why_not +
                    "; ask for another number of vertices");
  if (!is_made) {
    report.count.why = "the walls of its regions are as they came in";
    return walls_themselves(*p.walls);
  }
  TriangleMesh mesh = mesh_of(p, walls.joined, run);
  if (int64_t(mesh.vertices.size()) > p.target.vertices)
    report.count.why = "the curves between its regions, and walls close together, need them";
  warn_of_left_alone(walls.joined.left_alone, run);
  measure_edges(*p.cut, walls.joined, report.sizing);
  report.features.vertices = walls.joined.on_curves;
  report.features.segments = int64_t(mesh.features.curve_edges.size());
  report.features.kept = report.is_optimized = true;
  return mesh;
}

}  // namespace isoshell
