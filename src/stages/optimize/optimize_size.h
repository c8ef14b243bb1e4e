// How long edges of the result should be, for the optimisation.
#pragma once

#include "stages/labels/edge_lengths.h"

namespace isoshell::optimize {

/// Edge length by the sheet vertex that a vertex is at home at.
struct EdgeSize {
  double edge_q8 = 0;  ///< mean length; that of the least where lengths vary
  EdgeLengthsView lengths;

  /// Over the least.
  ISOSHELL_HD double ratio(uint32_t home) const {
    return lengths.vary() ? double(lengths.at[home]) / double(lengths.least) : 1;
  }
  ISOSHELL_HD double at(uint32_t home) const { return edge_q8 * ratio(home); }
};

}  // namespace isoshell::optimize
