// Which parts of a surface, components and handles, so many vertices can show, and what is said of those that they
// cannot.
#pragma once

#include "isoshell/remesh.h"

namespace isoshell {

/// Whether the vertices asked for can show each component and each handle of the input; clouds of smoke have hundreds.
bool shows_all_parts(const RemeshOptions& options, const InputTopology& input);

/// False for smoke and foam: walls and gaps are as narrow as handles are many, and would cross.
bool shows_most_handles(const RemeshOptions& options, const InputTopology& input);

/// Sheet components smaller than a few cells are noise of dirty input; a clean input has none to lose, unless there are
/// more than the vertices can show.
int64_t smallest_component_q16(const RemeshOptions& options, const InputTopology& input, const LatticeFrame& frame);

/// Warns where the sheet is not of the input's topology.
void warn_of_topology(const Prepared& prepared, const InputTopology& input, const RemeshOptions& options,
                      RemeshReport& report);

}  // namespace isoshell
