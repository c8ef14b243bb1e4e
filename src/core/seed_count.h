// How many seeds a sheet can carry.
#pragma once

#include "isoshell/advanced/sheet.h"

namespace isoshell {

/// Throws usage when `count` is below four a component or above half the sheet's vertices; names the resolution that
/// would do.
void require_seed_count(const Sheet& sheet, int64_t count);

}  // namespace isoshell
