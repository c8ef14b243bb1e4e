// See mesh_of_regions.h.
#include "pipeline/regions/mesh_of_regions.h"

#include <algorithm>
#include <utility>

#include "features/cutting/cut_surface.h"
#include "features/mesh/refine_mesh.h"
#include "pipeline/grid/attempt.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/grid/timed.h"
#include "pipeline/patches/cut_curves.h"
#include "pipeline/patches/patch_rounds.h"
#include "pipeline/patches/wide_angles.h"
#include "pipeline/regions/region_walls.h"

namespace isoshell {
namespace {

/// Per patch of a cut surface the regions that it parts.
std::vector<std::array<int32_t, 2>> labels_of_patches(const CutSurface& cut, const FaceRegions& regions) {
  std::vector<std::array<int32_t, 2>> labels(patch_count(cut), {0, 0});
  for (size_t t = 0; t < cut.fine->triangles.size(); ++t)
    labels[cut.surface.patch[cut.corner[3 * t]]] = regions.labels[cut.fine->source_face[t]];
  return labels;
}

FaceRegions without_labels(const FaceRegions& regions) {
  FaceRegions out;
  out.background = regions.background;
  out.are_of_voxels = regions.are_of_voxels;
  out.names = regions.names;
  return out;
}

/// The walls as they came in.
TriangleMesh walls_themselves(const RegionWalls& walls) {
  TriangleMesh mesh;
  mesh.vertices = walls.mesh.vertices;
  mesh.triangles = walls.mesh.triangles;  // each from its smallest corner, and sorted
  mesh.regions = without_labels(walls.regions);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) mesh.regions.labels.push_back(walls.labels_of(t));
  return mesh;
}

}  // namespace

TriangleMesh triangulate_regions(const PreparedSurface& p, SeededMesh& made, const PatchOptions& in_patches,
                                 RemeshReport& report, Context& context) {
  SharedCut cut = p.cut;
  JoinedPatches joined;
  const std::string why_not = failure_reason([&]() -> std::string {
    if (std::string why = mesh_in_rounds(p, cut, made, in_patches, report, context); !why.empty()) return why;
    joined =
        timed(report, "angles", context, [&] { return with_wide_angles(p, *cut, made, in_patches, report, context); });
    return "";
  });
  if (!why_not.empty()) {
    report.warnings.push_back("the walls of regions are as they came in, " +
                              std::to_string(p.walls->mesh.vertices.size()) + " vertices: " + why_not);
    report.optimize = {};
    return walls_themselves(*p.walls);
  }
  TriangleMesh mesh = to_world(joined.mesh, p.surface.frame);
  mesh.features = std::move(joined.features);
  mesh.regions = without_labels(p.walls->regions);
  const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(*cut, p.walls->regions);
  for (const uint32_t patch : mesh.features.patch) mesh.regions.labels.push_back(labels[patch]);
  if (const auto vertices = int64_t(mesh.vertices.size());
      vertices != p.target.vertices && !p.options.edge_length_world)
    report.warnings.push_back("the result has " + std::to_string(vertices) + " vertices instead of " +
                              std::to_string(p.target.vertices) + ": the curves between its regions need them");
  measure_edges(*cut, joined, report.sizing);
  report.features.vertices = joined.on_curves;
  report.features.segments = int64_t(mesh.features.curve_edges.size());
  report.features.kept = report.is_optimized = true;
  return mesh;
}

}  // namespace isoshell
