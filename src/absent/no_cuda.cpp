// Compiled instead of cuda/ when CUDA is off: an empty table.
#include "isoshell/advanced/device_memory.h"
#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "stages/cuda_device.h"

namespace isoshell {

const BackendTable* cuda_backend() { return nullptr; }
std::string why_not_cuda(int) { return "no CUDA device: this build has no CUDA backend; build with ISOSHELL_CUDA=on"; }
DeviceInfo cuda_device_info(int) { return {}; }
int64_t device_memory_peak_bytes(int) { return 0; }
void copy_from_device(void*, const void*, int64_t, int device) {
  throw Error(ErrorCode::no_device, "device", why_not_cuda(device));
}
void reset_device_memory_peak(int) {}

}  // namespace isoshell
