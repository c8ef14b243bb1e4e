// Keywords of Python through the one parser of the command's options.
#pragma once

#include <nanobind/nanobind.h>

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "vdb_isomesh/args.h"

namespace isoshell::python {

/// Names as the command has them, without dashes, and values as text; a flag has none.
using Keywords = std::vector<std::pair<std::string, std::optional<std::string>>>;

/// Throws: usage.
tool::Arguments arguments_of(const Keywords& keywords, const std::string& output);

/// option_table, which the package's own table of keywords is made from.
void bind_keywords(nanobind::module_& m);

}  // namespace isoshell::python
