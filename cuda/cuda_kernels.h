// The kernels of the device: what it does in its own way and why that is faster. See stages/plain_kernels.h.
#pragma once

#include "stages/plain_kernels.h"

namespace isoshell {

struct CudaKernels {
  using LabelSheet = PlainKernels::LabelSheet;
};

}  // namespace isoshell
