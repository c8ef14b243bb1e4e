// Host memory of Buffers.
#include <cstdlib>
#include <cstring>
#include <string>

#include "isoshell/advanced/buffer.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

int64_t rounded(int64_t bytes) { return (bytes + 63) / 64 * 64; }

class HostMemory final : public Memory {
 public:
  MemorySpace space() const override { return MemorySpace::host; }

  void* allocate(int64_t bytes) override {
    if (bytes <= 0) return nullptr;
    void* data = std::aligned_alloc(64, size_t(rounded(bytes)));
    if (!data)
      throw Error(ErrorCode::out_of_memory, "memory",
                  "out of memory: " + std::to_string(bytes) + " bytes more were refused; lower the resolution");
    return data;
  }

  void free(void* data, int64_t) noexcept override { std::free(data); }

  void copy_to_host(void* to, const void* from, int64_t bytes) override { std::memcpy(to, from, size_t(bytes)); }
};

}  // namespace

Memory& host_memory() {
  static HostMemory memory;
  return memory;
}

}  // namespace isoshell
