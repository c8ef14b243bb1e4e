// Copies between the streams of two contexts.
#include "cuda/runtime/executor_cuda.cuh"
#include "parity/cuda_streams.h"

namespace isoshell::parity {
namespace {

struct IsNot {
  View<const uint32_t> values;
  uint32_t expected;
  __device__ int64_t operator()(int64_t i) const { return values[i] != expected; }
};

}  // namespace

int64_t wrong_in_copy(Context& from, Context& to, int64_t count) {
  constexpr uint32_t kFills = 50;
  Buffer<uint32_t> copy;
  {
    CudaExecutor first(from, "test");
    Buffer<uint32_t> values = first.make<uint32_t>(count);
    for (uint32_t i = 1; i <= kFills; ++i) first.fill(values.view(), i);
    copy = CudaExecutor(to, "test").to_device(values);
    CudaExecutor(from, "test").fill(values.view(), 0u);
  }
  CudaExecutor again(from, "test");
  Buffer<uint32_t> other = again.make<uint32_t>(count);
  again.fill(other.view(), 0u);
  return CudaExecutor(to, "test").sum(count, IsNot{copy.view(), kFills});
}

}  // namespace isoshell::parity
