// See own_faces.h.
#include "pipeline/patches/own_faces.h"

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

/// Of points of the lattice. Where very many triangles meet at a vertex it is not looked at.
bool meets_itself(const FeatureMesh& mesh, const LatticeFrame& frame, const Context& context) {
  std::vector<uint32_t> around(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles)
    for (const uint32_t v : t)
      if (++around[v] > kMostAround) return false;
  return !crossings_of(mesh, frame, context).empty();
}

}  // namespace

void unite_own_faces(SearchedSurface& searched, PreparedSurface& p, RemeshReport& report, Context& context) {
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
  report.warnings.push_back(
      counted(united.cut_faces, "face was", "faces were") +
      " cut where the part touches or crosses itself, to within rounding; creases are those of what "
      "it encloses");
  const double rounding_world = searched.mesh.rounding_world;
  run_with_threads(context, [&] {
    searched.mesh = weld_for_features(whole);
    searched.mesh.rounding_world = rounding_world;
    remove_slivers(searched.mesh, p.surface.frame, {}, edge_of_strips_world(p), context);
    p.own_faces_meet = meets_itself(searched.mesh, p.surface.frame, context);
  });
  check_cancel(context, "features");
  searched.creases.reset();
}

}  // namespace isoshell
