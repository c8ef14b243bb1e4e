// How much memory a run may take.
#pragma once

#include <cstdint>
#include <string>

#include "isoshell/backend.h"
#include "isoshell/device_info.h"

namespace isoshell::tool {

/// Four fifths of the memory that is free to this process: the machine's, or its control group's (the folder `group`)
/// if that is less. At least 1, or 0 where the system does not tell.
int64_t default_memory_limit_bytes(const std::string& group = "/sys/fs/cgroup");

/// Gives a context without a limit that of the command: four fifths of what is free there, on its device or here.
void limit_memory(Context& context, const DeviceInfo& device);

}  // namespace isoshell::tool
