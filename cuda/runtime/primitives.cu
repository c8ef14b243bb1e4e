// See primitives.h.
#include "cuda/runtime/cub.cuh"
#include "cuda/runtime/primitives.h"
#include "cuda/runtime/scan_kernels.cuh"

namespace isoshell {
namespace {

/// Scratch for the time of one call.
class Scratch {
 public:
  Scratch(DeviceStream& stream, size_t bytes)
      : stream_(stream), bytes_(int64_t(bytes)), data_(stream.allocate(bytes_)) {}
  ~Scratch() {
    if (data_) stream_.free(data_, bytes_);
  }
  Scratch(const Scratch&) = delete;
  void* data() const { return data_; }

 private:
  DeviceStream& stream_;
  int64_t bytes_;
  void* data_;
};

/// Calls algorithm(scratch, bytes) twice, as CUB wants it: for the size, then to work.
template <class Algorithm>
void run_cub(DeviceStream& stream, const char* name, Algorithm algorithm) {
  size_t bytes = 0;
  require_success(algorithm(nullptr, bytes), name);
  const Scratch scratch(stream, bytes > 0 ? bytes : 1);
  require_success(algorithm(scratch.data(), bytes), name);
}

__global__ void list_kept(View<const uint32_t> words, View<const uint32_t> rank, View<uint32_t> out) {
  const int64_t i = int64_t(blockIdx.x) * blockDim.x + threadIdx.x, w = i >> 5;
  if (w >= words.size) return;
  const uint32_t word = words[w], bit = 1u << (i & 31);
  if (word & bit) out[rank[w] + uint32_t(__popc(word & (bit - 1)))] = uint32_t(i);
}

constexpr int kThreads = 256;

}  // namespace

void exclusive_scan_async(DeviceStream& stream, View<int64_t> values) {
  if (values.empty()) return;
  scan_kernels::launch_scan<false>(stream, values.size - 1, scan_kernels::ValueAt<int64_t>{values}, values,
                                   static_cast<int64_t*>(nullptr), HostBell{});
  require_success(cudaGetLastError(), "scan");
}

void sort_keys_async(DeviceStream& stream, View<uint64_t> keys, int bits) {
  if (keys.size < 2) return;
  const Scratch other(stream, size_t(keys.size) * sizeof(uint64_t));
  cub::DoubleBuffer<uint64_t> both(keys.data, static_cast<uint64_t*>(other.data()));
  run_cub(stream, "sort", [&](void* scratch, size_t& bytes) {
    return cub::DeviceRadixSort::SortKeys(scratch, bytes, both, keys.size, 0, bits, stream.stream());
  });
  if (both.Current() != keys.data)
    require_success(cudaMemcpyAsync(keys.data, both.Current(), size_t(keys.size) * sizeof(uint64_t),
                                    cudaMemcpyDeviceToDevice, stream.stream()),
                    "cudaMemcpyAsync");
}

void list_kept_async(DeviceStream& stream, View<const uint32_t> words, View<const uint32_t> rank, View<uint32_t> out) {
  if (words.empty()) return;
  list_kept<<<blocks_for(words.size * 32, kThreads), kThreads, 0, stream.stream()>>>(words, rank, out);
  require_success(cudaGetLastError(), "list kept");
}

}  // namespace isoshell
