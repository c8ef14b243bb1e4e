// Kernels of one stream that follow closely on one another: the blocks of the next one take the room that the last
// blocks of this one leave, and wait there until it has ended. Code for chips before sm_90 runs them in turn.
#pragma once

#include "cuda/runtime/executor_cuda.cuh"

namespace isoshell {

/// The first thing in a kernel that CloseLauncher launches: after it, what earlier kernels wrote is there.
__device__ inline void wait_for_earlier_kernels() {
#if __CUDA_ARCH__ >= 900
  asm volatile("griddepcontrol.wait;" ::: "memory");
  asm volatile("griddepcontrol.launch_dependents;" ::: "memory");
#endif
}

/// Launches kernels of one parameter, in the executor's stream; closely if that is wanted and their code waits, which
/// code for an older chip does not, though the device may be new.
class CloseLauncher {
 public:
  template <class Parameter>
  CloseLauncher(CudaExecutor& exec, bool closely, void (*kernel)(Parameter)) : exec_(exec) {
    cudaFuncAttributes code;
    require_success(cudaFuncGetAttributes(&code, kernel), "cudaFuncGetAttributes");
    closely_.id = cudaLaunchAttributeProgrammaticStreamSerialization;
    closely_.val.programmaticStreamSerializationAllowed = 1;
    closely_count_ = closely && code.ptxVersion >= 90 ? 1 : 0;
  }

  template <class Parameter>
  void launch(void (*kernel)(Parameter), unsigned blocks, unsigned threads, const Parameter& parameter) {
    cudaLaunchConfig_t launch{};
    launch.gridDim = dim3(blocks);
    launch.blockDim = dim3(threads);
    launch.stream = exec_.stream();
    launch.attrs = &closely_;
    launch.numAttrs = closely_count_;
    require_success(cudaLaunchKernelEx(&launch, kernel, parameter), "cudaLaunchKernelEx");
  }

 private:
  CudaExecutor& exec_;
  cudaLaunchAttribute closely_{};
  unsigned closely_count_;
};

}  // namespace isoshell
