// What runs the stages, for people and logs.
#pragma once

#include <cstdint>
#include <string>

#include "isoshell/backend.h"

namespace isoshell {

struct DeviceInfo {
  std::string backend = "cpu";  ///< "cpu" or "cuda"; what follows is of the CUDA device
  int number = -1;
  std::string name;            ///< as its driver says it
  std::string driver_version;  ///< release of the driver, as 580.65.06; empty where the system does not tell
  std::string cuda_version;    ///< newest CUDA that the driver runs, as 13.0
  int64_t memory_bytes = 0, free_bytes = 0;
};

/// Where this context's stages run. Throws: no_device when it asks for a CUDA device that is not there or cannot run
/// them.
DeviceInfo device_info(const Context& context);

/// Largest number of bytes that Buffers held on a CUDA device at one time since the last reset; 0 where none did.
int64_t device_memory_peak_bytes(int device);
void reset_device_memory_peak(int device);

}  // namespace isoshell
