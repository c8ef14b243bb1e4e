// Copies from a stream's memory to the host: a few bytes through pinned words, many piece by piece, and those of other
// threads beside the stream.
#include <algorithm>
#include <cstring>
#include <memory>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "cuda/runtime/device_stream.h"
#include "cuda/runtime/host_bell.cuh"

namespace isoshell {
namespace {

__global__ void write_to_host(const uint8_t* from, int64_t bytes, uint8_t* to, HostBell bell) {
  for (int64_t i = threadIdx.x; i < bytes; i += blockDim.x) to[i] = from[i];
  __threadfence_system();
  __syncthreads();
  if (threadIdx.x == 0) ring(bell);
}

constexpr int64_t kStagedBytes = int64_t(1) << 20;  ///< of a copy to the host, at once

}  // namespace

void DeviceStream::copy_to_host(void* to, const void* from, int64_t bytes) {
  if (bytes <= 0) return;
  if (is_used_here()) {
    if (bytes <= kPinnedBytes) return copy_few_to_host(to, from, bytes);
    if (bytes > kStagedBytes && has_staging())
      return copy_many_to_host(static_cast<char*>(to), static_cast<const char*>(from), bytes);
  }
  if (!is_users_thread()) return copy_beside(to, from, bytes);
  require_success(cudaMemcpyAsync(to, from, size_t(bytes), cudaMemcpyDeviceToHost, stream_), "cudaMemcpyAsync");
  synchronize();
}

/// In a stream that no context uses at the moment, or in this one where no other is to be had.
void DeviceStream::copy_beside(void* to, const void* from, int64_t bytes) {
  const std::unique_ptr<DeviceStream, decltype(&give_back)> borrowed(borrow_beside(), give_back);
  DeviceStream& stream = borrowed ? *borrowed : *this;
  if (borrowed) stream.wait_for(*this);
  require_success(cudaMemcpyAsync(to, from, size_t(bytes), cudaMemcpyDeviceToHost, stream.stream_), "cudaMemcpyAsync");
  stream.synchronize();
}

/// Whether the calling thread runs the stream's stages.
bool DeviceStream::is_users_thread() const { return user_.load() == std::this_thread::get_id(); }

/// And on its device: pinned words and staging are for one thread.
bool DeviceStream::is_used_here() const {
  int current = -1;
  return is_users_thread() && cudaGetDevice(&current) == cudaSuccess && current == device();
}

/// False where the host has no more pinned memory.
bool DeviceStream::has_staging() {
  for (Staging& s : staging_) {
    if (!s.copied) require_success(cudaEventCreateWithFlags(&s.copied, cudaEventDisableTiming), "cudaEventCreate");
    if (s.pinned || cudaMallocHost(&s.pinned, size_t(kStagedBytes)) == cudaSuccess) continue;
    cudaGetLastError();
    s.pinned = nullptr;
    return false;
  }
  return true;
}

void DeviceStream::copy_few_to_host(void* to, const void* from, int64_t bytes) {
  constexpr int64_t kMostThreads = 256;
  write_to_host<<<1, unsigned(std::min(bytes, kMostThreads)), 0, stream_>>>(
      static_cast<const uint8_t*>(from), bytes, static_cast<uint8_t*>(pinned_), next_bell());
  require_success(cudaGetLastError(), "write to the host");
  wait_for_bell();
  std::memcpy(to, pinned_, size_t(bytes));
}

/// Piece by piece through pinned memory. The driver's way is bound by one thread that touches new pages.
void DeviceStream::copy_many_to_host(char* to, const char* from, int64_t bytes) {
  Context limits;
  limits.threads = threads_;
  const int64_t pieces = (bytes + kStagedBytes - 1) / kStagedBytes;
  const auto size = [&](int64_t piece) { return std::min(kStagedBytes, bytes - piece * kStagedBytes); };
  for (int64_t piece = 0; piece <= pieces; ++piece) {
    if (piece < pieces) {
      const Staging& s = staging_[piece % 2];
      require_success(
          cudaMemcpyAsync(s.pinned, from + piece * kStagedBytes, size_t(size(piece)), cudaMemcpyDeviceToHost, stream_),
          "cudaMemcpyAsync");
      require_success(cudaEventRecord(s.copied, stream_), "cudaEventRecord");
    }
    if (piece == 0) continue;
    const Staging& s = staging_[(piece - 1) % 2];
    require_success(cudaEventSynchronize(s.copied), "cudaEventSynchronize");
    char* const out = to + (piece - 1) * kStagedBytes;
    constexpr int64_t kBytesAtATime = 1 << 16;
    run_with_threads(limits, [&] {
      for_ranges(size(piece - 1), kBytesAtATime, [&](int64_t begin, int64_t end) {
        std::memcpy(out + begin, static_cast<const char*>(s.pinned) + begin, size_t(end - begin));
      });
    });
  }
}

}  // namespace isoshell
