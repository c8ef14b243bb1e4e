// See own_faces.h.
#include "pipeline/patches/own_faces.h"

#include <algorithm>

#include "core/watched.h"
#include "features/mesh/remove_slivers.h"
#include "features/mesh/weld_for_features.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/boolean_union.h"
#include "isoshell/readable.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/patches/new_crossings.h"

namespace isoshell {
namespace {

constexpr uint32_t kMostAround = 1024;  ///< triangles at a vertex: all pairs of them are looked at
/// Of the lattice. What is nearer is made one, as parts that are nearer to each other than rounding moves them would
/// meet again once they are rounded. More bends sheets that were moved apart into each other again.
constexpr double kNearSteps = .5;

bool has_very_many_at_vertex(const FeatureMesh& mesh) {
  std::vector<uint32_t> around(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles)
    for (const uint32_t v : t)
      if (++around[v] > kMostAround) return true;
  return false;
}

/// Parts that were apart by less than a step may share edges.
bool has_edges_of_many_faces(const SearchedSurface& searched) {
  const std::vector<CurveEdge>& found = searched.creases->curve_edges;
  return std::any_of(found.begin(), found.end(), [](const CurveEdge& e) { return e.kind == CurveKind::non_manifold; });
}

}  // namespace

void unite_own_faces(SearchedSurface& searched, PreparedSurface& p, Run& run) {
  Context& context = run.context;
  const LatticeFrame& frame = p.surface.frame;
  if (has_very_many_at_vertex(searched.mesh)) return;
  const bool meets = has_edges_of_many_faces(searched) ||
                     run_with_threads(context, [&] { return !crossings_of(searched.mesh, frame, context).empty(); });
  check_cancel(context, "features");
  if (!meets) return;
  TriangleSoup soup;
  soup.vertices = searched.mesh.vertices;
  soup.triangles = searched.mesh.triangles;
  const UnionOptions options{p.options.outer_only, false, frame.voxel_size * kSheetGapVox, true,
                             kNearSteps * frame.voxel_size / kOneVoxelQ8};
  UnionReport united;
  const TriangleSoup whole = boolean_union(soup, options, united, context).soup;
  if (!united.changed_anything()) return;
  const InputTopology after = measure_topology(whole, context).topology;
  if (!after.closed || !after.oriented) return;
  if (united.cut_faces > 0)
    run.warn(counted(united.cut_faces, "face was", "faces were") +
             " cut where the part touches or crosses itself, to within rounding; creases are those of what "
             "it encloses");
  const double rounding_world = searched.mesh.rounding_world;
  run_with_threads(context, [&] {
    searched.mesh = weld_for_features(whole);
    searched.mesh.rounding_world = rounding_world;
    remove_slivers(searched.mesh, frame, {}, edge_of_strips_world(p), context);
    p.own_faces_meet = !has_very_many_at_vertex(searched.mesh) && !crossings_of(searched.mesh, frame, context).empty();
  });
  check_cancel(context, "features");
  searched.creases.reset();
}

}  // namespace isoshell
