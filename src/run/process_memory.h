// What the system says about this process's memory.
#pragma once

#include <cstdint>

namespace isoshell {

/// Most memory the process held at any time, code and libraries included; 0 where the system does not tell.
int64_t process_peak_bytes();

}  // namespace isoshell
