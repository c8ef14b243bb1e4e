// coarsen_walls (see coarsen_walls.h).
#include "features/walls/coarsen_walls.h"

#include <utility>

#include "core/watched.h"
#include "features/angles/widen_angles.h"
#include "features/walls/coarsen.h"
#include "features/walls/even_out.h"

namespace isoshell {

PatchMesh coarsen_walls(const CutSurface& cut, const WallTriangles& walls, const JoinOptions& options,
                        const Context& context) {
  return run_with_threads(context, [&] {
    WallMesh mesh(cut, walls);
    coarsen(mesh, options.vertices, context);
    even_out(mesh, options.vertices, context);
    auto lookup = mesh.shared_lookup();
    return PatchMesh(std::move(lookup), std::move(mesh), options);
  });
}

JoinedPatches widened_to_count(PatchMesh mesh, const Context& context) {
  widen(mesh, context);
  const JoinOptions options = mesh.options();
  if (options.is_steady || 10 * mesh.surplus() <= options.vertices) return mesh.joined();
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
