// The CUDA side of a Context: a stream on one device and the memory that is allocated in that stream's order.
#pragma once

#include <cuda_runtime_api.h>

#include <atomic>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "isoshell/advanced/buffer.h"
#include "isoshell/backend.h"

namespace isoshell {

/// What to say of an error, which is cleared. After a kernel's fault it says that the device is lost to the process.
std::string describe_error(cudaError_t status);
/// Throws Error{internal} that names the call when `status` is an error.
void require_success(cudaError_t status, const char* call);

/// Thread blocks for `count` elements.
inline unsigned blocks_for(int64_t count, int64_t per_block) { return unsigned((count + per_block - 1) / per_block); }

struct DevicePool;

/// A word of pinned memory, and what a kernel writes to it in the end; see host_bell.cuh.
struct HostBell {
  uint32_t* word;
  uint32_t number;
};

/// What a tile of a scan tells later ones, and tiles of a scan with a number of its own; see scan_kernels.cuh.
struct alignas(16) TileState {
  uint64_t sum, mark;
};
struct ScanTiles {
  TileState* state;
  uint64_t number;
};
/// What the blocks of a sum leave for one another: zero between two sums.
struct SumState {
  unsigned long long sum;
  unsigned blocks_done;
};

/// Memory of one device, allocated and freed in the order of one stream, from a pool that keeps what is freed. Small
/// blocks that were freed are handed out again without asking the driver: a run takes a thousand of them. Lives as long
/// as the process: contexts borrow it, and Buffers may outlive them.
class DeviceStream final : public Memory {
 public:
  /// The context's own; made, and its device chosen, at first use. Throws: no_device.
  static DeviceStream& of(Context& context);

  DeviceStream(DevicePool& pool, int processors, cudaStream_t stream, cudaEvent_t event, void* pinned);
  MemorySpace space() const override { return MemorySpace::cuda; }
  void* allocate(int64_t bytes) override;
  void free(void* data, int64_t bytes) noexcept override;
  /// From any thread. The one that runs the context's stages has ways that are faster than the driver's; what others
  /// copy holds up nothing that the stream goes on to do.
  void copy_to_host(void* to, const void* from, int64_t bytes) override;

  void copy_to_device(void* to, const void* from, int64_t bytes);
  int device() const;
  /// As many thread blocks as are needed, but no more than `per_processor` for each of the device's multiprocessors.
  unsigned resident_blocks(int64_t needed, int per_processor) const {
    const int64_t most = int64_t(processors_) * per_processor;
    return unsigned(needed < 1 ? 1 : needed < most ? needed : most);
  }
  int processors() const { return processors_; }
  cudaStream_t stream() const { return stream_; }
  /// Waits for everything in the stream.
  void synchronize();
  /// For the next kernel. wait_for_bell waits until it rings, so for everything in the stream before it.
  HostBell next_bell() { return {bell_, ++bells_}; }
  void wait_for_bell();
  /// For the next kernel that scans so many tiles.
  ScanTiles next_scan(int64_t tiles);
  /// For the next kernel that sums.
  SumState* sum_state();
  /// Work that is enqueued from now on starts after all that is in `other`, a stream of the same device. The host does
  /// not wait.
  void wait_for(const DeviceStream& other);
  static constexpr int64_t kLargestKept = int64_t(8) << 20;  ///< bytes of a block that is kept when freed
  /// A few words of pinned host memory for read-backs.
  static constexpr int64_t kPinnedBytes = 4032;
  void* pinned() const { return pinned_; }
  /// Bytes of the Buffers that the stream serves. A context is given a stream that serves none: they are its own.
  int64_t held_bytes() const { return held_bytes_; }
  /// Gives the small blocks that were kept back to the device's pool.
  void release_kept() noexcept;

 private:
  /// One of the device, the current one, that no context uses. It is given back as what it was borrowed as.
  static DeviceStream* borrow(int device);
  static void give_back(void* stream) noexcept;
  /// The same from any thread, whose current device stays. Null where there is none without changing that.
  DeviceStream* borrow_beside() const noexcept;
  void* take(int64_t bytes);
  bool is_users_thread() const;
  bool is_used_here() const;
  bool has_staging();
  void copy_beside(void* to, const void* from, int64_t bytes);
  void copy_few_to_host(void* to, const void* from, int64_t bytes);
  void copy_many_to_host(char* to, const char* from, int64_t bytes);
  void make_tiles(int64_t tiles);

  DevicePool& pool_;
  int processors_;
  cudaStream_t stream_;
  cudaEvent_t event_;  ///< for others to wait for
  void* pinned_;
  uint32_t* bell_;              ///< behind them
  uint32_t bells_ = 0;          ///< so far
  TileState* tiles_ = nullptr;  ///< behind a SumState; not counted as held
  int64_t tile_count_ = 0;
  uint64_t scans_ = 0;  ///< so far
  struct Staging {
    void* pinned = nullptr;
    cudaEvent_t copied = nullptr;
  };
  Staging staging_[2];  ///< for large copies to the host; made for the first one
  // Of the context that uses the stream.
  int64_t limit_ = 0;  ///< in bytes; 0 means none
  int threads_ = 0;
  std::atomic<std::thread::id> user_{};  ///< who runs its stages
  std::atomic<int64_t> held_bytes_{0};
  std::mutex kept_mutex_;                                 ///< Buffers are freed on any thread
  std::unordered_map<int64_t, std::vector<void*>> kept_;  ///< by their sizes
};

}  // namespace isoshell
