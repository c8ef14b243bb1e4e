// coarsen_walls (see coarsen_walls.h).
#include "features/walls/coarsen_walls.h"

#include <utility>

#include "core/watched.h"
#include "features/angles/widen_angles.h"
#include "features/walls/coarsen.h"
#include "features/walls/even_out.h"
#include "features/walls/periodic_sides.h"

namespace isoshell {

void coarsen_walls(WallMesh& mesh, int64_t vertices, const Context& context) {
  run_with_threads(context, [&] {
    coarsen(mesh, vertices, context);
    even_out(mesh, vertices, context);
  });
}

JoinedPatches widened_to_count(PatchMesh mesh, const Context& context) {
  widen(mesh, context);
  const JoinOptions options = mesh.options();
  if (has_periodic_sides(mesh.lookup().cut())) {
    const auto lookup = mesh.shared_lookup();
    mesh = PatchMesh(lookup, run_with_threads(context, [&] { return with_same_sides(*lookup, std::move(mesh)); }),
                     options);
    widen(mesh, context);
  }
  if (options.is_steady || mesh.surplus() <= 0) return mesh.joined();
  const int64_t left_alone = mesh.left_alone();
  return run_with_threads(context, [&] {
    const auto lookup = mesh.shared_lookup();
    WallMesh again(lookup, std::move(mesh));
    coarsen(again, options.vertices, context);
    JoinedPatches joined = PatchMesh(lookup, std::move(again), options).joined();
    joined.left_alone = left_alone;
    return joined;
  });
}

JoinedPatches widened_to_count(const CutSurface& cut, const SeededMesh& made, const JoinOptions& options,
                               const Context& context) {
  return widened_to_count(run_with_threads(context, [&] { return PatchMesh(cut, made, options); }), context);
}

}  // namespace isoshell
