// Compiled instead of cuda/ when CUDA is off: an empty table.
#include "stages/backend_table.h"

namespace isoshell {

const BackendTable* cuda_backend() { return nullptr; }

}  // namespace isoshell
