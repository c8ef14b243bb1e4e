// CUDA's build_level_set, and its surface.
#include "core/vector_view.h"
#include "cuda/cuda_backend.h"
#include "cuda/level_set/level_set_cooperative.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/level_set/level_set_body.h"
#include "stages/level_set/level_set_surface_body.h"

namespace isoshell {

LevelSetSurface CudaBackend::level_set_surface(const LatticeSurface& surface, const TriangleSoup* exact,
                                               const Sheet& sheet, SheetPart part, Context& context) const {
  CudaExecutor exec(context, "level-set");
  Buffer<WorldPoint> vertices;
  Buffer<std::array<uint32_t, 3>> triangles;
  if (exact && part != SheetPart::alone) {
    vertices = exec.upload(view_of(exact->vertices));
    triangles = exec.upload(view_of(exact->triangles));
  }
  return level_set_surface_body(exec, *OnDevice<LatticeSurface>(exec, surface), {vertices.view(), triangles.view()},
                                *OnDevice<Sheet>(exec, sheet), part);
}

LevelSet CudaBackend::build_level_set(const LevelSetSurface& surface, const SiteSet& sites, const Sheet& sheet,
                                      const LevelSetOptions& options, Context& context) const {
  CudaExecutor exec(context, "level-set");
  return build_level_set_body(exec, *OnDevice<LevelSetSurface>(exec, surface), *OnDevice<SiteSet>(exec, sites),
                              *OnDevice<Sheet>(exec, sheet), options);
}

}  // namespace isoshell
