// Memory of a CUDA device that others hold, such as the tensors of a program.
#pragma once

#include <cstdint>

namespace isoshell {

/// Copies to the host what lies at `from` on a device when all work is done that its legacy default stream was given
/// before, or waits for. Makes the device the calling thread's own. Throws: no_device where it is not there, or the
/// build has no CUDA; internal when the copy fails.
void copy_from_device(void* to, const void* from, int64_t bytes, int device);

}  // namespace isoshell
