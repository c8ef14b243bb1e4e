// Which backend a context gets.
#include "stages/backend_table.h"

#include "isoshell/error.h"
#include "stages/cuda_device.h"

namespace isoshell {

const BackendTable& backend_for(const Context& context) {
  if (context.backend == Backend::cpu) return cpu_backend();
  const std::string why_not = why_not_cuda(context.device);
  if (why_not.empty()) return *cuda_backend();
  if (context.backend == Backend::cuda)
    throw Error(ErrorCode::no_device, "device", why_not + "; use --device cpu or auto");
  return cpu_backend();
}

void finish_stages(Context& context) { backend_for(context).finish_stages(context); }

const char* backend_name(const Context& context) { return backend_for(context).name(); }

DeviceInfo device_info(const Context& context) {
  return &backend_for(context) == &cpu_backend() ? DeviceInfo() : cuda_device_info(context.device);
}

}  // namespace isoshell
