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

/// Of points of the lattice. Where very many triangles meet at a vertex it is not looked at.
bool meets_itself(const FeatureMesh& mesh, const LatticeFrame& frame, const Context& context) {
  std::vector<uint32_t> around(mesh.vertices.size(), 0);
  for (const auto& t : mesh.triangles)
    for (const uint32_t v : t)
      if (++around[v] > kMostAround) return false;
  return !crossings_of(mesh, frame, context).empty();
}

/// Parts that were apart by less than a step may share edges.
bool has_edges_of_many_faces(const SearchedSurface& searched) {
  const std::vector<CurveEdge>& found = searched.creases->curve_edges;
  return std::any_of(found.begin(), found.end(), [](const CurveEdge& e) { return e.kind == CurveKind::non_manifold; });
}

/// Of a union that makes one what is nearer than half a step of the frame's lattice, or more where the surface is
/// longer than kSteps of these: parts that lie nearer to each other than rounding moves them would be apart, and meet
/// once they are rounded.
WorldBox box_of_union(const LatticeFrame& frame) {
  constexpr int32_t kSteps = 1 << 19;
  const int32_t longest_vox = *std::max_element(frame.extent_vox, frame.extent_vox + 3);
  const double side = std::max(kSteps / kOneVoxelQ8, longest_vox) * frame.voxel_size;
  return {frame.origin, frame.origin + WorldPoint{side, side, side}};
}

}  // namespace

void unite_own_faces(SearchedSurface& searched, PreparedSurface& p, RemeshReport& report, Context& context) {
  const LatticeFrame& frame = p.surface.frame;
  const bool meets = has_edges_of_many_faces(searched) ||
                     run_with_threads(context, [&] { return meets_itself(searched.mesh, frame, context); });
  check_cancel(context, "features");
  if (!meets) return;
  TriangleSoup soup;
  soup.vertices = searched.mesh.vertices;
  soup.triangles = searched.mesh.triangles;
  const UnionOptions options{p.options.outer_only, false, frame.voxel_size * kSheetGapVox, true, box_of_union(frame)};
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
    remove_slivers(searched.mesh, frame, {}, edge_of_strips_world(p), context);
    p.own_faces_meet = meets_itself(searched.mesh, frame, context);
  });
  check_cancel(context, "features");
  searched.creases.reset();
}

}  // namespace isoshell
