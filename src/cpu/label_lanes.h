// Labels on the CPU: the definition of stages/label_body.h, all vertices of a leaf against one seed after the other.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/label_body.h"

namespace isoshell {

/// Taken instead of the template of stages/label_body.h.
void label_sheet(TbbExecutor& exec, const Sheet& sheet, const SeedSet& seeds, const SeedSpacing& spacing,
                 View<uint32_t> labels);

}  // namespace isoshell
