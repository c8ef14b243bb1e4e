// Which backend a context gets.
#include "stages/backend_table.h"

#include "isoshell/error.h"

namespace isoshell {

const BackendTable& backend_for(const Context& context) {
  if (context.backend == Backend::cpu) return cpu_backend();
  if (const BackendTable* cuda = cuda_backend()) return *cuda;
  if (context.backend == Backend::cuda)
    throw Error(ErrorCode::no_device, "device",
                "no CUDA device: this build or this machine has none; use --device cpu or auto");
  return cpu_backend();
}

const char* backend_name(const Context& context) { return backend_for(context).name; }

}  // namespace isoshell
