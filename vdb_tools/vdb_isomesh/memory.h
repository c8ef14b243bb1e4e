// How much memory a run may take.
#pragma once

#include <cstdint>

namespace isoshell::tool {

/// Four fifths of the memory that is free to this process: the machine's, or its control group's if that is less.
/// 0 where the system does not tell.
int64_t default_memory_limit_bytes();

/// Most memory the process held at any time, code and libraries included.
int64_t process_peak_bytes();

}  // namespace isoshell::tool
