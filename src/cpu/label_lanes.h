// Labels on the CPU: the definition of stages/label_body.h, all vertices of a leaf against one seed after the other.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/label_body.h"

namespace isoshell {

/// Labels one sheet for seeds that move: what does not change is found once, and the labels of the time before say how
/// far to look.
class LabelLanes {
 public:
  LabelLanes(TbbExecutor& exec, const Sheet& sheet, const SeedSpacing& spacing);

  /// Writes the labels for `seeds`. `labels` holds those of the time before, or kNone everywhere.
  void label(TbbExecutor& exec, const SeedSet& seeds, View<uint32_t> labels) const;

 private:
  const Sheet& sheet_;
  const SeedSpacing spacing_;
  Buffer<label::Bounds> bounds_;  ///< of every leaf's vertices
};

/// Taken instead of the template of stages/label_body.h.
void label_sheet(TbbExecutor& exec, const Sheet& sheet, const SeedSet& seeds, const SeedSpacing& spacing,
                 View<uint32_t> labels);

}  // namespace isoshell
