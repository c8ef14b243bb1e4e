// The operations of the CUDA executor.
#include "cuda/runtime/executor_cuda.cuh"

namespace isoshell::parity {

template <class T>
Buffer<T> to_executor(CudaExecutor& exec, const Buffer<T>& values) {
  return exec.to_device(values);
}

}  // namespace isoshell::parity

#include "parity/executor_operations_body.h"

namespace isoshell::parity {

std::unique_ptr<ExecutorOperations> cuda_executor_operations(Context& context) {
  return std::make_unique<OperationsOf<CudaExecutor>>(context);
}

}  // namespace isoshell::parity
