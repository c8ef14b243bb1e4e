// Compiled instead of cuda_executor_operations.cu when CUDA is off.
#include "parity/executor_operations.h"

namespace isoshell::parity {

std::unique_ptr<ExecutorOperations> cuda_executor_operations(Context&) { return nullptr; }

}  // namespace isoshell::parity
