// The operations of the CPU's executor.
#include "cpu/executor_tbb.h"

namespace isoshell::parity {

template <class T>
Buffer<T> to_executor(TbbExecutor&, Buffer<T> values) {
  return values;
}

}  // namespace isoshell::parity

#include "parity/executor_operations_body.h"

namespace isoshell::parity {

std::unique_ptr<ExecutorOperations> tbb_executor_operations(Context& context) {
  return std::make_unique<OperationsOf<PlainExecutor>>(context);
}

}  // namespace isoshell::parity
