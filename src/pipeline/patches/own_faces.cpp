// See own_faces.h.
#include "pipeline/patches/own_faces.h"

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "features/mesh/remove_slivers.h"
#include "features/mesh/weld_for_features.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/boolean_union.h"
#include "measure/crossings.h"

namespace isoshell {
namespace {

/// Of points of the lattice.
bool meets_itself(const FeatureMesh& mesh, const LatticeFrame& frame, const Context& context) {
  Buffer<PointQ8> points(int64_t(mesh.vertices.size()));
  Buffer<TriangleIndices> triangles(int64_t(mesh.triangles.size()));
  for_each_index(size_t(0), mesh.vertices.size(), [&](size_t v) { points[v] = frame.snap(mesh.vertices[v]); });
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    triangles[t] = {mesh.triangles[t][0], mesh.triangles[t][1], mesh.triangles[t][2]};
  });
  return !crossing_pairs(points.view(), triangles.view(), {}, context.cancel).empty();
}

}  // namespace

void unite_own_faces(SearchedSurface& searched, const PreparedSurface& p, RemeshReport& report, Context& context) {
  const bool meets = run_with_threads(context, [&] { return meets_itself(searched.mesh, p.surface.frame, context); });
  check_cancel(context, "features");
  if (!meets) return;
  TriangleSoup soup;
  soup.vertices = searched.mesh.vertices;
  soup.triangles = searched.mesh.triangles;
  const UnionOptions options{p.options.outer_only, false, p.surface.frame.voxel_size * kSheetGapVox, true};
  UnionReport united;
  const TriangleSoup whole = boolean_union(soup, options, united, context).soup;
  if (!united.changed_anything()) return;
  const InputTopology after = measure_topology(whole, context).topology;
  if (!after.closed || !after.oriented) return;
  report.input.united.cut_faces += united.cut_faces;
  const double rounding_world = searched.mesh.rounding_world;
  run_with_threads(context, [&] {
    searched.mesh = weld_for_features(whole);
    searched.mesh.rounding_world = rounding_world;
    remove_slivers(searched.mesh, {});
  });
  searched.creases.reset();
}

}  // namespace isoshell
