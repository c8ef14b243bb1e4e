// The CUDA executor: exec/executor.h over a stream. Steps run one a thread, or as their CooperativeKernel says; words
// that return a value to the host wait for the stream, all others only enqueue.
#pragma once

#include <algorithm>
#include <functional>
#include <string>
#include <type_traits>

#include "core/copy_product.h"
#include "cuda/cuda_kernels.h"
#include "cuda/runtime/cooperative_kernel.cuh"
#include "cuda/runtime/cub.cuh"
#include "cuda/runtime/device_stream.h"
#include "cuda/runtime/primitives.h"
#include "cuda/runtime/scan_kernels.cuh"
#include "cuda/runtime/warp.cuh"
#include "isoshell/error.h"

namespace isoshell {
namespace cuda_steps {

constexpr int kThreads = 128;
inline unsigned blocks_for(int64_t count) { return isoshell::blocks_for(count, kThreads); }
__device__ inline int64_t thread_number() { return int64_t(blockIdx.x) * blockDim.x + threadIdx.x; }

template <class Step>
__global__ void run_step(int64_t count, Step step) {
  const int64_t i = thread_number();
  if (i < count) step(i);
}

template <class T>
__global__ void fill_values(View<T> out, T value) {
  const int64_t i = thread_number();
  if (i < out.size) out[i] = value;
}

}  // namespace cuda_steps

/// One per stage call.
class CudaExecutor {
 public:
  using Kernels = CudaKernels;

  CudaExecutor(Context& context, const char* stage)
      : context_(context), stage_(stage), stream_(DeviceStream::of(context)) {}

  /// Passes of a loop that are enqueued before its state is read, which waits for them.
  static constexpr int kPassBatch = 16;

  Context& context() { return context_; }
  DeviceStream& device() { return stream_; }
  cudaStream_t stream() const { return stream_.stream(); }

  void stop_if_cancelled() const {
    if (context_.cancel.load(std::memory_order_relaxed)) throw Error(ErrorCode::interrupted, stage_, "interrupted");
  }
  /// Throws what went wrong with the launches so far, and Error{interrupted} when the context was cancelled.
  void check(const char* name) {
    if (const cudaError_t status = cudaGetLastError(); status != cudaSuccess)
      throw Error(ErrorCode::internal, stage_, std::string(name) + " failed on the device: " + describe_error(status));
    stop_if_cancelled();
  }

  template <class T>
  Buffer<T> make(int64_t count) {
    return Buffer<T>(count, stream_);
  }

  template <class T>
  void fill(View<T> out, T value) {
    stop_if_cancelled();
    if (out.empty()) return;
    cuda_steps::fill_values<<<cuda_steps::blocks_for(out.size), cuda_steps::kThreads, 0, stream()>>>(out, value);
    check("fill");
  }

  template <class T>
  void copy(View<const T> from, View<T> to) {
    if (from.empty()) return;
    require_success(
        cudaMemcpyAsync(to.data, from.data, size_t(from.size) * sizeof(T), cudaMemcpyDeviceToDevice, stream()), "copy");
  }

  template <class T>
  T value(View<const T> values, int64_t i) {
    static_assert(kHasNoPadding<T>, "nothing writes padding: give it members");
    T out;
    stream_.copy_to_host(&out, values.data + i, sizeof(T));
    return out;
  }

  template <class Step>
  void for_each(const char* name, int64_t count, Step step) {
    stop_if_cancelled();
    if (count <= 0) return;
    if constexpr (Kernels::CooperativeSteps::has<Step>)
      launch_cooperative_kernel(count, step, stream());
    else
      cuda_steps::run_step<<<cuda_steps::blocks_for(count), cuda_steps::kThreads, 0, stream()>>>(count, step);
    check(name);
  }

  template <class T>
  T exclusive_scan(View<T> counts) {
    return exclusive_scan_of(counts.size, scan_kernels::ValueAt<T>{counts}, counts);
  }

  template <class T, class Term>
  T exclusive_scan_of(int64_t count, Term term, View<T> out) {
    stop_if_cancelled();
    if (count <= 0) {
      fill(out, T(0));
      return 0;
    }
    T* const total = static_cast<T*>(stream_.pinned());
    launch_scan<false>(count, term, out, total, stream_.next_bell());
    stream_.wait_for_bell();
    return *total;
  }

  template <class T>
  void inclusive_scan(View<T> counts) {
    stop_if_cancelled();
    if (counts.empty()) return;
    launch_scan<true>(counts.size, scan_kernels::ValueAt<T>{counts}, counts, static_cast<T*>(nullptr), HostBell{});
  }

  template <class T, class Less = std::less<T>>
  void sort(View<T> keys, Less less = {}) {
    static_assert(kHasNoPadding<T>, "nothing writes padding: give it members");
    stop_if_cancelled();  // before some thirty launches
    if (keys.size < 2) return;
    if constexpr (std::is_same_v<T, uint64_t> && std::is_same_v<Less, std::less<T>>) {
      constexpr int64_t kFewerLaunchesToMerge = 1 << 17;
      if (keys.size > kFewerLaunchesToMerge) return sort_keys_async(stream_, keys);
    }
    size_t bytes = 0;
    require_success(cub::DeviceMergeSort::SortKeys(nullptr, bytes, keys.data, keys.size, less, stream()), "sort");
    Buffer<uint8_t> scratch = make<uint8_t>(int64_t(bytes));
    require_success(cub::DeviceMergeSort::SortKeys(scratch.data(), bytes, keys.data, keys.size, less, stream()),
                    "sort");
  }

  template <class Keep>
  Buffer<uint32_t> select(int64_t count, Keep keep) {
    stop_if_cancelled();
    if (count <= 0) return {};
    constexpr int64_t kMostWithRoomForAll = 1 << 16;
    return count <= kMostWithRoomForAll ? select_with_room_for_all(count, keep) : select_in_two_steps(count, keep);
  }

  template <class Term>
  int64_t sum(int64_t count, Term term) {
    stop_if_cancelled();
    if (count <= 0) return 0;
    int64_t* const total = static_cast<int64_t*>(stream_.pinned());
    launch_sum(count, term, total, stream_.next_bell());
    stream_.wait_for_bell();
    return *total;
  }

  template <class Term>
  void sum_into(View<int64_t> out, int64_t count, Term term) {
    stop_if_cancelled();
    if (count <= 0) return fill(out, int64_t(0));
    launch_sum(count, term, out.data, HostBell{});
  }

  /// Whether steps may use a product as it lies: made in this stream, so in the order of its work.
  template <class Product>
  bool owns(const Product& product) const {
    return lies_where(product, [&](const Memory& memory) { return &memory == &stream_; });
  }

  /// A copy of any Buffer in this stream's memory. The owner of the Buffer may free it right away: another stream of
  /// the device waits for the copy; what lies on another device goes through the host.
  template <class T>
  Buffer<T> to_device(const Buffer<T>& from) {
    if (from.space() == MemorySpace::cuda) {
      auto& owner = static_cast<DeviceStream&>(from.memory());
      if (owner.device() == stream_.device()) return copy_in_order(from, owner);
      return to_device(from.to_host());
    }
    return upload(from.view());
  }
  /// Of an array on the host.
  template <class T>
  Buffer<T> upload(View<const T> from) {
    Buffer<T> copy = make<T>(from.size);
    stream_.copy_to_device(copy.data(), from.data, copy.size_bytes());
    return copy;
  }

 private:
  template <class T>
  Buffer<T> copy_in_order(const Buffer<T>& from, DeviceStream& owner) {
    Buffer<T> copy = make<T>(from.size());
    stream_.wait_for(owner);
    this->copy(from.view(), copy.view());
    owner.wait_for(stream_);
    return copy;
  }

  ScanTiles tiles_for(int64_t count) { return stream_.next_scan(scan_kernels::tiles_for(count)); }

  template <bool kInclusive, class T, class Term>
  void launch_scan(int64_t count, Term term, View<T> out, T* total, HostBell bell) {
    scan_kernels::launch_scan<kInclusive>(stream_, count, term, out, total, bell);
    check("scan");
  }

  template <class Keep>
  Buffer<uint32_t> select_with_room_for_all(int64_t count, Keep keep) {
    Buffer<uint32_t> out = make<uint32_t>(count);
    uint32_t* const total = static_cast<uint32_t*>(stream_.pinned());
    const auto kernel = scan_kernels::are_few(count) ? scan_kernels::select<scan_kernels::per_thread(true), Keep>
                                                     : scan_kernels::select<scan_kernels::per_thread(false), Keep>;
    kernel<<<scan_kernels::tiles_for(count), scan_kernels::kThreads, 0, stream()>>>(
        count, keep, out.data(), tiles_for(count), total, stream_.next_bell());
    check("select");
    stream_.wait_for_bell();
    out.shorten(*total);
    return out;
  }

  template <class Keep>
  Buffer<uint32_t> select_in_two_steps(int64_t count, Keep keep) {
    Buffer<uint32_t> words = make<uint32_t>((count + 31) / 32), rank = make<uint32_t>(words.size());
    uint32_t* const total = static_cast<uint32_t*>(stream_.pinned());
    scan_kernels::mark_kept<scan_kernels::per_thread(false)>
        <<<scan_kernels::tiles_for(count), scan_kernels::kThreads, 0, stream()>>>(
            count, keep, words.view(), rank.data(), tiles_for(count), total, stream_.next_bell());
    check("select");
    stream_.wait_for_bell();
    Buffer<uint32_t> out = make<uint32_t>(*total);
    if (!out.empty()) list_kept_async(stream_, words.view(), rank.view(), out.view());
    return out;
  }

  template <class Term>
  void launch_sum(int64_t count, Term term, int64_t* out, HostBell bell) {
    constexpr int64_t kMostBlocks = 1024;
    const unsigned blocks = unsigned(std::min(kMostBlocks, int64_t(blocks_for(count, scan_kernels::kThreads))));
    scan_kernels::sum<<<blocks, scan_kernels::kThreads, 0, stream()>>>(count, term, stream_.sum_state(), out, bell);
    check("sum");
  }

  Context& context_;
  const char* stage_;
  DeviceStream& stream_;
};

/// A product where steps can read it: itself, or a copy that lives as long as this.
template <class Product>
class OnDevice {
 public:
  OnDevice(CudaExecutor& exec, const Product& product) : product_(&product) {
    if (exec.owns(product)) return;
    copy_ = copy_product(product, [&](const auto& buffer) { return exec.to_device(buffer); });
    product_ = &copy_;
  }
  OnDevice(const OnDevice&) = delete;
  const Product& operator*() const { return *product_; }
  const Product* operator->() const { return product_; }

 private:
  const Product* product_;
  Product copy_;
};

/// Brings a product that a stage changes to the executor's memory.
template <class Product>
Product& on_device(CudaExecutor& exec, Product& product) {
  if (!exec.owns(product)) product = copy_product(product, [&](const auto& buffer) { return exec.to_device(buffer); });
  return product;
}

}  // namespace isoshell
