// What the library takes as options.
#pragma once

#include "isoshell/remesh.h"

namespace isoshell {

/// The options without the numbers that stood for "not given" before options had no value: 0, and -1 of closings and
/// the tolerance. Throws: usage that names the option, its value and the limits.
RemeshOptions checked(RemeshOptions options);

}  // namespace isoshell
