// Kernels over rows of leaves that fill the device: what they take, and how they are launched.
#pragma once

#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/shell/closest_tables.cuh"

namespace isoshell {
namespace closest {

struct Arguments {
  Rows rows;
  Input in;
  Output out;
};

/// A distance transform that fills the device.
struct Transform {
  void (*kernel)(Rows, Input, Output);
  unsigned blocks, threads;
  int shared_bytes;

  void run(CudaExecutor& exec, const Arguments& a, const char* name) const {
    kernel<<<blocks, threads, size_t(shared_bytes), exec.stream()>>>(a.rows, a.in, a.out);
    exec.check(name);
  }
};

inline Transform transform_of(CudaExecutor& exec, decltype(Transform::kernel) kernel, int warps, int64_t shared_bytes) {
  Transform t = {kernel, 0, unsigned(warps * 32), int(shared_bytes)};
  require_success(cudaFuncSetAttribute(t.kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, t.shared_bytes),
                  "cudaFuncSetAttribute");
  int blocks = 0;
  require_success(
      cudaOccupancyMaxActiveBlocksPerMultiprocessor(&blocks, t.kernel, int(t.threads), size_t(t.shared_bytes)),
      "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  t.blocks = unsigned(blocks * exec.device().processors());
  return t;
}

}  // namespace closest
}  // namespace isoshell
