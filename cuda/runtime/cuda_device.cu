// Which CUDA devices there are, whether stages can run on them, and what they are called.
#include <cuda_runtime_api.h>

#include <fstream>
#include <string>
#include <vector>

#include "cuda/runtime/device_stream.h"
#include "isoshell/advanced/device_memory.h"
#include "isoshell/error.h"
#include "stages/cuda_device.h"

namespace isoshell {
namespace {

constexpr int kOldestCapability = 75;  // the oldest architecture that the build compiles for unless told otherwise

std::string version_text(int version) {
  return std::to_string(version / 1000) + "." + std::to_string(version % 1000 / 10);
}

/// Why there is no device at all; empty when `count` holds how many there are.
std::string why_no_device(int& count) {
  const cudaError_t status = cudaGetDeviceCount(&count);
  if (status == cudaSuccess && count > 0) return "";
  cudaGetLastError();
  int driver = 0;
  if (cudaDriverGetVersion(&driver) != cudaSuccess) driver = 0;
  if (driver > 0 && status == cudaErrorInsufficientDriver)
    return "no CUDA device: the driver is too old, it runs CUDA up to " + version_text(driver) +
           " and this build needs " + version_text(CUDART_VERSION) + "; update the driver";
  if (driver == 0) return "no CUDA device: this machine has no NVIDIA driver";
  if (status == cudaSuccess || status == cudaErrorNoDevice) return "no CUDA device: this machine has none";
  return std::string("no CUDA device: ") + cudaGetErrorString(status);
}

std::string device_name(int device) {
  cudaDeviceProp properties;
  return cudaGetDeviceProperties(&properties, device) == cudaSuccess ? properties.name : "unknown";
}

std::string why_not_device(int device) {
  int major = 0, minor = 0, mode = 0;
  cudaDeviceGetAttribute(&major, cudaDevAttrComputeCapabilityMajor, device);
  cudaDeviceGetAttribute(&minor, cudaDevAttrComputeCapabilityMinor, device);
  cudaDeviceGetAttribute(&mode, cudaDevAttrComputeMode, device);
  const std::string which = "CUDA device " + std::to_string(device) + " (" + device_name(device) + ")";
  if (10 * major + minor < kOldestCapability)
    return which + " has compute capability " + std::to_string(major) + "." + std::to_string(minor) +
           "; it takes 7.5 or newer";
  if (mode == cudaComputeModeProhibited) return which + " is closed to programs (compute mode prohibited)";
  int pools = 0;
  cudaDeviceGetAttribute(&pools, cudaDevAttrMemoryPoolsSupported, device);
  if (pools == 0) return which + " has no memory pools; a newer driver may bring them";
  return "";
}

/// Found once: devices do not come and go while a process runs.
struct Devices {
  std::string why_none;
  std::vector<std::string> why_not;

  Devices() {
    int count = 0;
    why_none = why_no_device(count);
    if (!why_none.empty()) return;
    for (int d = 0; d < count; ++d) why_not.push_back(why_not_device(d));
    cudaGetLastError();
  }
};
const Devices& devices() {
  static const Devices found;
  return found;
}

/// "NVRM version: NVIDIA UNIX x86_64 Kernel Module  580.65.06  Sun Jul ...": the first word that is a number with dots.
std::string driver_release() {
  std::ifstream file("/proc/driver/nvidia/version");
  for (std::string word; file >> word;)
    if (word.find_first_not_of("0123456789.") == std::string::npos && word.find('.') != std::string::npos) return word;
  return "";
}

}  // namespace

std::string why_not_cuda(int device) {
  const Devices& found = devices();
  if (!found.why_none.empty()) return found.why_none;
  const int count = int(found.why_not.size());
  if (device < 0 || device >= count)
    return "no CUDA device " + std::to_string(device) + ": this machine has " + std::to_string(count) +
           (count == 1 ? ", number 0" : ", numbers 0 to " + std::to_string(count - 1));
  return found.why_not[size_t(device)];
}

DeviceInfo cuda_device_info(int device) {
  DeviceInfo info;
  info.backend = "cuda";
  info.number = device;
  info.name = device_name(device);
  info.driver_version = driver_release();
  int driver = 0;
  if (cudaDriverGetVersion(&driver) == cudaSuccess) info.cuda_version = version_text(driver);
  size_t free_bytes = 0, bytes = 0;
  require_success(cudaSetDevice(device), "cudaSetDevice");
  require_success(cudaMemGetInfo(&free_bytes, &bytes), "cudaMemGetInfo");
  info.memory_bytes = int64_t(bytes);
  info.free_bytes = int64_t(free_bytes);
  return info;
}

void copy_from_device(void* to, const void* from, int64_t bytes, int device) {
  if (const std::string why_not = why_not_cuda(device); !why_not.empty())
    throw Error(ErrorCode::no_device, "device", why_not);
  require_success(cudaSetDevice(device), "cudaSetDevice");
  require_success(cudaMemcpyAsync(to, from, size_t(bytes), cudaMemcpyDeviceToHost, cudaStreamLegacy),
                  "cudaMemcpyAsync");
  require_success(cudaStreamSynchronize(cudaStreamLegacy), "cudaStreamSynchronize");
}

}  // namespace isoshell
