// CUDA's improve_mesh.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"
#include "cuda/label_forms.cuh"
#include "cuda/post_kernels.cuh"
#include "stages/post_body.h"

namespace isoshell {

PostReport CudaBackend::improve_mesh(const Sheet& sheet, const PostOptions& options, SeedSet& seeds, DualMesh& mesh,
                                     Context& context) const {
  CudaExecutor exec(context, "post");
  return improve_mesh_body(exec, *OnDevice<Sheet>(exec, sheet), options, on_device(exec, seeds), on_device(exec, mesh));
}

}  // namespace isoshell
