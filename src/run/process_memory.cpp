#include "run/process_memory.h"

#include <sys/resource.h>

namespace isoshell {

int64_t process_peak_bytes() {
  rusage usage{};
  return getrusage(RUSAGE_SELF, &usage) == 0 ? int64_t(usage.ru_maxrss) * 1024 : 0;
}

}  // namespace isoshell
