// Labels on the CPU: the definition of stages/labels/label_body.h, all vertices of a block against one seed after the
// other.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/labels/label_body.h"

namespace isoshell {

/// Labels one sheet for seeds that move, each in its patch: what does not change is found once, and the seeds in the
/// middle of blocks say how far to look the next time.
class LabelSimd {
 public:
  LabelSimd(CpuExecutor& exec, const SurfaceMesh& surface, const SeedSpacing& spacing);

  void label(CpuExecutor& exec, const SeedSet& seeds, View<uint32_t> labels);

  /// Once, for CpuKernels.
  static void run(CpuExecutor& exec, const SurfaceMesh& surface, const SeedSet& seeds, const SeedSpacing& spacing,
                  View<uint32_t> labels) {
    LabelSimd(exec, surface, spacing).label(exec, seeds, labels);
  }

 private:
  const SurfaceMesh& surface_;
  const SeedSpacing spacing_;
  Buffer<label::Bounds> bounds_;  ///< of every block's vertices
  Buffer<uint32_t> middle_;       ///< the seed that was nearest to the middle of the bounds, kNone at first
};

}  // namespace isoshell
