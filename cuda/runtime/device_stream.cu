// Streams and device memory.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <iterator>
#include <mutex>
#include <string>
#include <vector>

#include "cuda/runtime/device_stream.h"
#include "isoshell/device_info.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

cudaMemPool_t make_pool(int device) {
  cudaMemPoolProps properties = {};
  properties.allocType = cudaMemAllocationTypePinned;
  properties.location = {cudaMemLocationTypeDevice, device};
  cudaMemPool_t pool;
  require_success(cudaMemPoolCreate(&pool, &properties), "cudaMemPoolCreate");
  uint64_t keep_all = UINT64_MAX;
  require_success(cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &keep_all), "cudaMemPoolSetAttribute");
  return pool;
}

}  // namespace

/// What the streams of a device share.
struct DevicePool {
  explicit DevicePool(int number) : device(number), pool(make_pool(number)) {}

  const int device;
  const cudaMemPool_t pool;
  std::atomic<int64_t> held_bytes{0}, peak_bytes{0};
  std::mutex idle_mutex;
  std::vector<DeviceStream*> idle;  ///< streams that no context uses at the moment
};

namespace {

struct DevicePools {
  std::mutex mutex;
  std::vector<DevicePool*> of_device;
};
/// Never destroyed: contexts and Buffers may end after static objects do.
DevicePools& all_pools() {
  static DevicePools* all = new DevicePools;
  return *all;
}

/// Null when the device was not used yet.
DevicePool* find_pool(int device) {
  DevicePools& all = all_pools();
  const std::lock_guard<std::mutex> lock(all.mutex);
  return device >= 0 && device < int(all.of_device.size()) ? all.of_device[size_t(device)] : nullptr;
}

DevicePool& pool_of(int device) {
  DevicePools& all = all_pools();
  const std::lock_guard<std::mutex> lock(all.mutex);
  if (int(all.of_device.size()) <= device) all.of_device.resize(size_t(device) + 1, nullptr);
  DevicePool*& pool = all.of_device[size_t(device)];
  if (!pool) pool = new DevicePool(device);
  return *pool;
}

/// The last idle stream that holds nothing, or null. What an earlier context left in a stream would count towards the
/// limit of the next one, and when it is freed, give it room above the limit.
DeviceStream* take_idle_stream(DevicePool& pool) {
  const std::lock_guard<std::mutex> lock(pool.idle_mutex);
  const auto found = std::find_if(pool.idle.rbegin(), pool.idle.rend(),
                                  [](const DeviceStream* stream) { return stream->held_bytes() == 0; });
  if (found == pool.idle.rend()) return nullptr;
  DeviceStream* const taken = *found;
  pool.idle.erase(std::next(found).base());
  return taken;
}

__global__ void probe() {}

/// The build may hold machine code for other chips only, and the driver may be too old to make it from PTX.
void require_code(int device) {
  cudaFuncAttributes attributes;
  const cudaError_t status = cudaFuncGetAttributes(&attributes, probe);
  const bool is_missing = status == cudaErrorNoKernelImageForDevice || status == cudaErrorInvalidDeviceFunction ||
                          status == cudaErrorUnsupportedPtxVersion || status == cudaErrorInvalidPtx ||
                          status == cudaErrorJitCompilerNotFound;
  if (!is_missing) return require_success(status, "cudaFuncGetAttributes");
  cudaGetLastError();
  throw Error(ErrorCode::no_device, "device",
              "this build has no machine code for CUDA device " + std::to_string(device) + " (" +
                  cudaGetErrorString(status) +
                  "): update the driver, build with CMAKE_CUDA_ARCHITECTURES for its chip, or use --device cpu");
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

/// What a kernel of this or another context leaves behind when it fails.
static bool is_fault(cudaError_t status) {
  switch (status) {
    case cudaErrorIllegalAddress:
    case cudaErrorIllegalInstruction:
    case cudaErrorInvalidAddressSpace:
    case cudaErrorInvalidPc:
    case cudaErrorLaunchFailure:
    case cudaErrorLaunchTimeout:
    case cudaErrorMisalignedAddress:
    case cudaErrorHardwareStackError:
    case cudaErrorAssert:
    case cudaErrorECCUncorrectable:
      return true;
    default:
      return false;
  }
}

std::string describe_error(cudaError_t status) {
  const std::string what = cudaGetErrorString(status);
  cudaGetLastError();                           // said here; the next check is about what comes next
  const cudaError_t stays = cudaFree(nullptr);  // a kernel's fault stays with every call of the process
  cudaGetLastError();
  if (!is_fault(stays)) return what;
  return what + "; a kernel of this process failed, and no context of it can use the device any more: start it again";
}

void require_success(cudaError_t status, const char* call) {
  if (status == cudaSuccess) return;
  throw Error(status == cudaErrorMemoryAllocation ? ErrorCode::out_of_memory : ErrorCode::internal, "cuda",
              std::string(call) + " failed: " + describe_error(status));
}

DeviceStream* DeviceStream::borrow(int device) {
  DevicePool& pool = pool_of(device);
  if (DeviceStream* const idle = take_idle_stream(pool)) return idle;
  int processors = 0;
  require_success(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device),
                  "cudaDeviceGetAttribute");
  cudaStream_t stream;
  require_success(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "cudaStreamCreate");
  cudaEvent_t event;
  require_success(cudaEventCreateWithFlags(&event, cudaEventDisableTiming), "cudaEventCreate");
  void* pinned;
  require_success(cudaMallocHost(&pinned, kPinnedBytes + sizeof(uint32_t)), "cudaMallocHost");
  return new DeviceStream(pool, processors, stream, event, pinned);
}

DeviceStream* DeviceStream::borrow_beside() const noexcept {
  if (DeviceStream* const idle = take_idle_stream(pool_)) return idle;
  int current = -1;
  if (cudaGetDevice(&current) != cudaSuccess || current != device()) return nullptr;
  try {
    return borrow(device());
  } catch (const Error&) {
    return nullptr;
  }
}

void DeviceStream::give_back(void* stream) noexcept {
  auto* idle = static_cast<DeviceStream*>(stream);
  if (idle->held_bytes() > 0) idle->release_kept();  // the next context takes another stream
  DevicePool& pool = pool_of(idle->device());
  const std::lock_guard<std::mutex> lock(pool.idle_mutex);
  pool.idle.push_back(idle);
}

DeviceStream& DeviceStream::of(Context& context) {
  const auto* mine = static_cast<const DeviceStream*>(context.backend_state_.get());
  if (!mine || mine->device() != context.device) {
    require_success(cudaSetDevice(context.device), "cudaSetDevice");
    require_code(context.device);
    context.backend_state_ = std::shared_ptr<void>(borrow(context.device), give_back);
  }
  DeviceStream& stream = *static_cast<DeviceStream*>(context.backend_state_.get());
  require_success(cudaSetDevice(stream.device()), "cudaSetDevice");
  stream.limit_ = context.memory_limit_bytes;
  stream.threads_ = context.threads;
  stream.user_ = std::this_thread::get_id();
  return stream;
}

DeviceStream::DeviceStream(DevicePool& pool, int processors, cudaStream_t stream, cudaEvent_t event, void* pinned)
    : pool_(pool),
      processors_(processors),
      stream_(stream),
      event_(event),
      pinned_(pinned),
      bell_(reinterpret_cast<uint32_t*>(static_cast<char*>(pinned) + kPinnedBytes)) {
  *bell_ = 0;
}

int DeviceStream::device() const { return pool_.device; }

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
    if (cudaMallocFromPoolAsync(&data, size_t(bytes), pool_.pool, stream_) == cudaSuccess) return data;
    cudaGetLastError();
    release_kept();
    const std::lock_guard<std::mutex> lock(pool_.idle_mutex);
    for (DeviceStream* idle : pool_.idle) {
      idle->release_kept();
      cudaStreamSynchronize(idle->stream_);  // the pool hands out at once what no stream may still use
    }
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
  const int64_t held_before = held_bytes_;
  const bool allowed = limit_ <= 0 || held_before + bytes <= limit_;
  void* data = allowed ? take(rounded(bytes)) : nullptr;
  if (!data) {
    throw Error(ErrorCode::out_of_memory, "memory",
                "out of device memory: " + std::to_string(bytes >> 20) + " MiB more than the " +
                    std::to_string(held_before >> 20) + " MiB in use were refused" +
                    (allowed ? "; lower the resolution or use --device cpu"
                             : " by the limit of " + std::to_string(limit_ >> 20) +
                                   " MiB; lower the resolution, raise --max-memory or use --device cpu"));
  }
  held_bytes_ += bytes;
  const int64_t held = pool_.held_bytes += bytes;
  int64_t peak = pool_.peak_bytes.load();
  while (held > peak && !pool_.peak_bytes.compare_exchange_weak(peak, held)) {
  }
  return data;
}

void DeviceStream::free(void* data, int64_t bytes) noexcept {
  held_bytes_ -= bytes;
  pool_.held_bytes -= bytes;
  if (rounded(bytes) > kLargestKept) {
    cudaFreeAsync(data, stream_);
    return;
  }
  const std::lock_guard<std::mutex> lock(kept_mutex_);
  kept_[rounded(bytes)].push_back(data);
}

void DeviceStream::copy_to_device(void* to, const void* from, int64_t bytes) {
  if (bytes <= 0) return;
  require_success(cudaMemcpyAsync(to, from, size_t(bytes), cudaMemcpyHostToDevice, stream_), "cudaMemcpyAsync");
}

void DeviceStream::synchronize() { require_success(cudaStreamSynchronize(stream_), "cudaStreamSynchronize"); }

void DeviceStream::wait_for_bell() {
  using Clock = std::chrono::steady_clock;
  constexpr auto kLongWait = std::chrono::microseconds(200);
  constexpr int kLooks = 64;  // between two at the clock
  const auto has_rung = [&] { return __atomic_load_n(bell_, __ATOMIC_ACQUIRE) == bells_; };
  for (const Clock::time_point start = Clock::now(); Clock::now() - start < kLongWait;)
    for (int look = 0; look < kLooks; ++look)
      if (has_rung()) return;
  synchronize();  // says what failed, where something did
  if (!has_rung()) throw Error(ErrorCode::internal, "cuda", "a kernel ended without an answer");
}

/// Kernels of the stream that use the ones before have been enqueued: memory is freed and cleared in its order.
void DeviceStream::make_tiles(int64_t tiles) {
  static_assert(sizeof(SumState) == sizeof(TileState), "a tile's place in front is room for it");
  constexpr int64_t kFewest = 1024;
  tile_count_ = std::max(tiles, kFewest);
  if (tiles_) cudaFreeAsync(tiles_ - 1, stream_);
  tiles_ = nullptr;
  const size_t bytes = size_t(tile_count_ + 1) * sizeof(TileState);
  void* const room = take(int64_t(bytes));
  if (!room)
    throw Error(ErrorCode::out_of_memory, "memory",
                "out of device memory for a scan's " + std::to_string(tiles) + " tiles; use --device cpu");
  require_success(cudaMemsetAsync(room, 0, bytes, stream_), "clear tiles");
  tiles_ = static_cast<TileState*>(room) + 1;
}

ScanTiles DeviceStream::next_scan(int64_t tiles) {
  if (!tiles_ || tiles > tile_count_) make_tiles(tiles);
  return {tiles_, ++scans_};
}

SumState* DeviceStream::sum_state() {
  if (!tiles_) make_tiles(0);
  return reinterpret_cast<SumState*>(tiles_ - 1);
}

void DeviceStream::wait_for(const DeviceStream& other) {
  require_success(cudaEventRecord(other.event_, other.stream_), "cudaEventRecord");
  require_success(cudaStreamWaitEvent(stream_, other.event_, 0), "cudaStreamWaitEvent");
}

int64_t device_memory_peak_bytes(int device) {
  const DevicePool* pool = find_pool(device);
  return pool ? pool->peak_bytes.load() : 0;
}
void reset_device_memory_peak(int device) {
  if (DevicePool* pool = find_pool(device)) pool->peak_bytes = pool->held_bytes.load();
}

}  // namespace isoshell
