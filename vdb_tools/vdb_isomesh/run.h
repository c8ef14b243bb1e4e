// One run, from INPUT to OUTPUT, with what a person reads of it.
#pragma once

#include "isoshell/backend.h"
#include "vdb_isomesh/args.h"
#include "vdb_isomesh/console.h"

namespace isoshell::tool {

/// Returns the exit status: 0, or 6 when a gate failed. Throws Error for everything else.
int run(const Arguments& arguments, Context& context, Console& console);

}  // namespace isoshell::tool
