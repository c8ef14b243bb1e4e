// coarsen_walls (see coarsen_walls.h).
#include "features/walls/coarsen_walls.h"

#include <utility>

#include "core/watched.h"
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

}  // namespace isoshell
