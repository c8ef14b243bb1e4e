// Streams and device memory.
#include <atomic>
#include <mutex>
#include <string>
#include <vector>

#include "cuda/device_stream.h"
#include "isoshell/device_info.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

std::atomic<int64_t> held_bytes{0}, peak_bytes{0};

/// One pool a device, made at first use and never destroyed.
cudaMemPool_t pool_of(int device) {
  static std::mutex mutex;
  static std::vector<cudaMemPool_t> pools;
  const std::lock_guard<std::mutex> lock(mutex);
  if (int(pools.size()) <= device) pools.resize(size_t(device) + 1, nullptr);
  cudaMemPool_t& pool = pools[size_t(device)];
  if (pool) return pool;
  cudaMemPoolProps properties = {};
  properties.allocType = cudaMemAllocationTypePinned;
  properties.location = {cudaMemLocationTypeDevice, device};
  require_success(cudaMemPoolCreate(&pool, &properties), "cudaMemPoolCreate");
  uint64_t keep_all = UINT64_MAX;
  require_success(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &keep_all), "cudaMemPoolSetAttribute");
  return pool;
}

/// Streams that no context uses at the moment.
struct FreeStreams {
  std::mutex mutex;
  std::vector<DeviceStream*> streams;
};
FreeStreams& free_streams() {
  static FreeStreams* all = new FreeStreams;  // contexts may end after static objects do
  return *all;
}

DeviceStream* take_stream(int device) {
  {
    FreeStreams& all = free_streams();
    const std::lock_guard<std::mutex> lock(all.mutex);
    for (DeviceStream*& s : all.streams)
      if (s->device() == device) {
        DeviceStream* taken = s;
        s = all.streams.back();
        all.streams.pop_back();
        return taken;
      }
  }
  int processors = 0;
  require_success(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device),
                  "cudaDeviceGetAttribute");
  cudaStream_t stream;
  require_success(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreate");
  void* pinned;
  require_success(cudaMallocHost(&pinned, DeviceStream::kPinnedBytes), "cudaMallocHost");
  return new DeviceStream(device, processors, stream, pinned);
}

__global__ void probe() {}

/// The build may hold machine code for other chips only.
void require_code(int device) {
  cudaFuncAttributes attributes;
  if (cudaFuncGetAttributes(&attributes, probe) == cudaSuccess) return;
  cudaGetLastError();
  throw Error(ErrorCode::no_device, "device",
              "this build has no machine code for CUDA device " + std::to_string(device) +
                  ": build with CMAKE_CUDA_ARCHITECTURES for its chip, or use --device cpu");
}

void return_stream(void* stream) {
  FreeStreams& all = free_streams();
  const std::lock_guard<std::mutex> lock(all.mutex);
  all.streams.push_back(static_cast<DeviceStream*>(stream));
}

/// Size of the block that serves this many bytes: four sizes from one power of two to the next, so that blocks fit
/// again. Large blocks are as asked.
int64_t rounded(int64_t bytes) {
  constexpr int64_t kSmallest = 512;
  if (bytes > DeviceStream::kLargestKept) return bytes;
  int64_t step = kSmallest / 4;
  while (step * 8 < bytes) step *= 2;
  return bytes <= kSmallest ? kSmallest : (bytes + step - 1) / step * step;
}

}  // namespace

void require_success(cudaError_t status, const char* call) {
  if (status == cudaSuccess) return;
  throw Error(status == cudaErrorMemoryAllocation ? ErrorCode::out_of_memory : ErrorCode::internal, "cuda",
              std::string(call) + " failed: " + cudaGetErrorString(status));
}

DeviceStream& DeviceStream::of(Context& context) {
  const auto* mine = static_cast<const DeviceStream*>(context.backend_state.get());
  if (!mine || mine->device() != context.device) {
    require_success(cudaSetDevice(context.device), "cudaSetDevice");
    require_code(context.device);
    context.backend_state = std::shared_ptr<void>(take_stream(context.device), return_stream);
  }
  DeviceStream& stream = *static_cast<DeviceStream*>(context.backend_state.get());
  require_success(cudaSetDevice(stream.device_), "cudaSetDevice");
  stream.set_limit(context.memory_limit_bytes);
  return stream;
}

DeviceStream::DeviceStream(int device, int processors, cudaStream_t stream, void* pinned)
    : device_(device), processors_(processors), stream_(stream), pinned_(pinned) {}

/// Null when the device has no more.
void* DeviceStream::take(int64_t bytes) {
  {
    const std::lock_guard<std::mutex> lock(kept_mutex_);
    const auto kept = kept_.find(bytes);
    if (kept != kept_.end() && !kept->second.empty()) {
      void* data = kept->second.back();
      kept->second.pop_back();
      return data;
    }
  }
  void* data = nullptr;
  for (int attempt = 0; attempt < 2; ++attempt) {
    if (cudaMallocFromPoolAsync(&data, size_t(bytes), pool_of(device_), stream_) == cudaSuccess) return data;
    cudaGetLastError();
    release_kept();
  }
  return nullptr;
}

void DeviceStream::release_kept() noexcept {
  const std::lock_guard<std::mutex> lock(kept_mutex_);
  for (auto& size : kept_) {
    for (void* data : size.second) cudaFreeAsync(data, stream_);
    size.second.clear();
  }
}

void* DeviceStream::allocate(int64_t bytes) {
  if (bytes <= 0) return nullptr;
  const bool allowed = limit_ <= 0 || held_bytes + bytes <= limit_;
  void* data = allowed ? take(rounded(bytes)) : nullptr;
  if (!data) {
    throw Error(ErrorCode::out_of_memory, "memory",
                "out of device memory: " + std::to_string(bytes >> 20) + " MiB more than the " +
                    std::to_string(held_bytes >> 20) + " MiB in use were refused" +
                    (allowed ? "; lower the resolution or use --device cpu"
                             : " by the limit of " + std::to_string(limit_ >> 20) +
                                   " MiB; lower the resolution, raise --max-memory or use --device cpu"));
  }
  const int64_t held = held_bytes += bytes;
  int64_t peak = peak_bytes.load();
  while (held > peak && !peak_bytes.compare_exchange_weak(peak, held)) {
  }
  return data;
}

void DeviceStream::free(void* data, int64_t bytes) noexcept {
  held_bytes -= bytes;
  if (rounded(bytes) > kLargestKept) {
    cudaFreeAsync(data, stream_);
    return;
  }
  const std::lock_guard<std::mutex> lock(kept_mutex_);
  kept_[rounded(bytes)].push_back(data);
}

void DeviceStream::copy_to_host(void* to, const void* from, int64_t bytes) {
  if (bytes <= 0) return;
  require_success(cudaMemcpyAsync(to, from, size_t(bytes), cudaMemcpyDeviceToHost, stream_), "cudaMemcpyAsync");
  synchronize();
}

void DeviceStream::copy_to_device(void* to, const void* from, int64_t bytes) {
  if (bytes <= 0) return;
  require_success(cudaMemcpyAsync(to, from, size_t(bytes), cudaMemcpyHostToDevice, stream_), "cudaMemcpyAsync");
}

void DeviceStream::synchronize() { require_success(cudaStreamSynchronize(stream_), "cudaStreamSynchronize"); }

int64_t device_memory_peak_bytes() { return peak_bytes; }
void reset_device_memory_peak() { peak_bytes = held_bytes.load(); }

}  // namespace isoshell
