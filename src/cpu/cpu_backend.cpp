// The CPU's table.
#include "cpu/cpu_backend.h"

namespace isoshell {

const char* CpuBackend::name() const { return "cpu"; }

const BackendTable& cpu_backend() {
  static const CpuBackend table;
  return table;
}

}  // namespace isoshell
