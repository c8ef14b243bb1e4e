// Which CUDA devices stages can run on.
#pragma once

#include <string>

#include "isoshell/device_info.h"

namespace isoshell {

/// Empty when stages can run on this CUDA device; otherwise why they cannot, as a message for people.
std::string why_not_cuda(int device);

/// Of a device that stages can run on.
DeviceInfo cuda_device_info(int device);

}  // namespace isoshell
