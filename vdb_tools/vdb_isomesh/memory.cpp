// Reads what the system says about memory.
#include "vdb_isomesh/memory.h"

#include <algorithm>
#include <fstream>

namespace isoshell::tool {
namespace {

int64_t available_bytes() {
  std::ifstream info("/proc/meminfo");
  std::string name, unit;
  for (int64_t kib; info >> name >> kib; std::getline(info, unit))
    if (name == "MemAvailable:") return kib * 1024;
  return 0;
}

int64_t number_in(const std::string& path) {
  std::ifstream file(path);
  int64_t number = -1;
  return file >> number ? number : -1;  // "max" is no number
}

/// Pages of files that lie idle: counted as used, and given back before a group runs out.
int64_t idle_file_bytes(const std::string& group) {
  std::ifstream stat(group + "/memory.stat");
  std::string name;
  for (int64_t bytes; stat >> name >> bytes;)
    if (name == "inactive_file") return bytes;
  return 0;
}

}  // namespace

int64_t default_memory_limit_bytes(const std::string& group) {
  int64_t free_bytes = available_bytes();
  const int64_t limit = number_in(group + "/memory.max"), used = number_in(group + "/memory.current");
  if (limit > 0 && used >= 0) {
    const int64_t left = std::max<int64_t>(limit - used + idle_file_bytes(group), 1);
    free_bytes = free_bytes > 0 ? std::min(free_bytes, left) : left;
  }
  return free_bytes > 0 ? std::max<int64_t>(free_bytes / 5 * 4, 1) : 0;
}

void limit_memory(Context& context, const DeviceInfo& device) {
  if (context.memory_limit_bytes > 0) return;
  context.memory_limit_bytes =
      device.backend == "cuda" ? std::max<int64_t>(device.free_bytes / 5 * 4, 1) : default_memory_limit_bytes();
}

}  // namespace isoshell::tool
