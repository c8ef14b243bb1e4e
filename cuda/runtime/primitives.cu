// Scans, sorts and compaction.
#include <climits>
#include <string>

#include "cuda/runtime/cub.cuh"
#include "cuda/runtime/primitives.h"
#include "isoshell/error.h"

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

/// Scans of CUB before 2.7 (CUDA 12.0 to 12.6) take an int, and would cut a longer count off without a word.
void require_scannable(int64_t count) {
#if CUB_VERSION < 200700
  if (count > INT_MAX)
    throw Error(ErrorCode::internal, "cuda",
                "a scan of " + std::to_string(count) + " elements: this build's CUDA scans at most " +
                    std::to_string(INT_MAX) + "; build with CUDA 12.8 or newer, or use --device cpu");
#else
  (void)count;
#endif
}

template <class T>
void exclusive_scan(DeviceStream& stream, View<T> values) {
  if (values.empty()) return;
  require_scannable(values.size);
  run_cub(stream, "exclusive scan", [&](void* scratch, size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, values.data, values.data, values.size, stream.stream());
  });
}
template <class T>
void inclusive_scan(DeviceStream& stream, View<T> values) {
  if (values.empty()) return;
  require_scannable(values.size);
  run_cub(stream, "inclusive scan", [&](void* scratch, size_t& bytes) {
    return cub::DeviceScan::InclusiveSum(scratch, bytes, values.data, values.data, values.size, stream.stream());
  });
}

__global__ void count_kept(View<const uint32_t> words, View<uint32_t> rank) {
  const int64_t w = int64_t(blockIdx.x) * blockDim.x + threadIdx.x;
  if (w < words.size) rank[w] = uint32_t(__popc(words[w]));
  if (w == words.size) rank[w] = 0;
}

__global__ void list_kept(View<const uint32_t> words, View<const uint32_t> rank, View<uint32_t> out) {
  const int64_t i = int64_t(blockIdx.x) * blockDim.x + threadIdx.x, w = i >> 5;
  if (w >= words.size) return;
  const uint32_t word = words[w], bit = 1u << (i & 31);
  if (word & bit) out[rank[w] + uint32_t(__popc(word & (bit - 1)))] = uint32_t(i);
}

constexpr int kThreads = 256;

}  // namespace

void exclusive_scan_async(DeviceStream& stream, View<int64_t> values) { exclusive_scan(stream, values); }
void exclusive_scan_async(DeviceStream& stream, View<uint32_t> values) { exclusive_scan(stream, values); }
void inclusive_scan_async(DeviceStream& stream, View<int64_t> values) { inclusive_scan(stream, values); }
void inclusive_scan_async(DeviceStream& stream, View<uint32_t> values) { inclusive_scan(stream, values); }

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

void rank_kept_async(DeviceStream& stream, View<const uint32_t> words, View<uint32_t> rank) {
  count_kept<<<blocks_for(words.size + 1, kThreads), kThreads, 0, stream.stream()>>>(words, rank);
  require_success(cudaGetLastError(), "count kept");
  exclusive_scan_async(stream, rank);
}

void list_kept_async(DeviceStream& stream, View<const uint32_t> words, View<const uint32_t> rank, View<uint32_t> out) {
  if (words.empty()) return;
  list_kept<<<blocks_for(words.size * 32, kThreads), kThreads, 0, stream.stream()>>>(words, rank, out);
  require_success(cudaGetLastError(), "list kept");
}

}  // namespace isoshell
