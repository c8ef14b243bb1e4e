// Compiled instead of cuda_words.cu when CUDA is off.
#include "parity/executor_words.h"

namespace isoshell::parity {

std::unique_ptr<ExecutorWords> cuda_words(Context&) { return nullptr; }

}  // namespace isoshell::parity
