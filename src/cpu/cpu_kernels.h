// The kernels of the CPU: what it does in its own way and why that is faster. See stages/plain_kernels.h.
#pragma once

#include "stages/plain_kernels.h"

namespace isoshell {

class LabelLanes;

struct CpuKernels {
  /// label_lanes.h: all vertices of a leaf are compared with one seed after the other, in lanes of vectors.
  using LabelSheet = LabelLanes;
};

}  // namespace isoshell
