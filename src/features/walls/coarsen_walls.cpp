// coarsen_walls (see coarsen_walls.h).
#include "features/walls/coarsen_walls.h"

#include "core/watched.h"
#include "features/walls/coarsen.h"
#include "features/walls/even_out.h"

namespace isoshell {

JoinedPatches coarsen_walls(const CutSurface& cut, const WallTriangles& walls, int64_t vertices,
                            const Context& context) {
  return run_with_threads(context, [&] {
    WallMesh mesh(cut, walls);
    coarsen(mesh, vertices, context);
    even_out(mesh, vertices, context);
    return PatchMesh(cut, mesh.vertices(), mesh.triangles(), {vertices}).joined();
  });
}

}  // namespace isoshell
