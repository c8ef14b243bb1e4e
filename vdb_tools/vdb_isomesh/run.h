// One run, from INPUT to OUTPUT, with what a person reads of it.
#pragma once

#include <functional>

#include "isoshell/backend.h"
#include "vdb_isomesh/args.h"
#include "vdb_isomesh/console.h"

namespace isoshell::tool {

/// Makes the page that the request names.
using WriteReport = std::function<void(const RunRequest& request, const RunResult& result)>;

/// Returns the exit status: 0, or 6 when a gate failed. Throws Error for everything else. A request of a report needs
/// `write_report`.
int run(const Arguments& arguments, Context& context, Console& console, const WriteReport& write_report);

}  // namespace isoshell::tool
