// CUDA's build_level_set.
#include "cuda/cuda_backend.h"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/level_set/level_set_body.h"

namespace isoshell {

/// The shell of the set has closest sites besides, which its distance transform finds at once.
struct CudaDilate {
  static VoxelSet run(CudaExecutor& exec, const SiteSet& sites, int32_t radius_vox) {
    return CudaBuildShell::run(exec, sites, {radius_vox}).voxels;
  }
};

LevelSet CudaBackend::build_level_set(const LevelSetSurface& surface, const SiteSet& sites, const Sheet& sheet,
                                      const LevelSetOptions& options, Context& context) const {
  CudaExecutor exec(context, "level-set");
  const auto corner = exec.upload(View<const WorldPoint>(surface.corner.view()));
  return build_level_set_body(exec, corner.view(), surface.first_of_sheet, *OnDevice<SiteSet>(exec, sites),
                              *OnDevice<Sheet>(exec, sheet), options);
}

}  // namespace isoshell
