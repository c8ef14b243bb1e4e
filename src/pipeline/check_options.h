// What the library takes as options.
#pragma once

#include "isoshell/remesh.h"

namespace isoshell {

/// Throws usage that names the option, its value and the limits.
void check_options(const RemeshOptions& options);

}  // namespace isoshell
