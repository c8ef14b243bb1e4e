// Reads what the system says about memory.
#include "vdb_isomesh/memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <string>

namespace isoshell::tool {
namespace {

int64_t available_bytes() {
  std::ifstream info("/proc/meminfo");
  std::string name, unit;
  for (int64_t kib; info >> name >> kib; std::getline(info, unit))
    if (name == "MemAvailable:") return kib * 1024;
  return 0;
}

int64_t number_in(const char* path) {
  std::ifstream file(path);
  int64_t number = -1;
  return file >> number ? number : -1;  // "max" is no number
}

}  // namespace

int64_t default_memory_limit_bytes() {
  int64_t free_bytes = available_bytes();
  const int64_t limit = number_in("/sys/fs/cgroup/memory.max"), used = number_in("/sys/fs/cgroup/memory.current");
  if (limit > 0 && used >= 0) {
    const int64_t left = std::max<int64_t>(limit - used, 1);
    free_bytes = free_bytes > 0 ? std::min(free_bytes, left) : left;
  }
  return free_bytes / 5 * 4;
}

int64_t process_peak_bytes() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? int64_t(usage.ru_maxrss) * 1024 : 0;
}

}  // namespace isoshell::tool
