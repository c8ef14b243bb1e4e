// CUDA's build_shell: the CPU's for the time being.
#include "cuda/cuda_backend.h"
#include "cuda/executor_cuda.cuh"

namespace isoshell {

Shell cuda_build_shell(const SiteSet& sites, const ShellOptions& options, Context& context) {
  CudaExecutor exec(context, "shell");
  Shell shell = cpu_backend().build_shell(sites, options, context);
  return std::move(on_device(exec, shell));
}

}  // namespace isoshell
