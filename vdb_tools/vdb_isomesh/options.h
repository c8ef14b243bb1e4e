// Every option of the command: those of a run, which the library knows, and the command's own.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "vdb_isomesh/args.h"

namespace isoshell::tool {

struct CommandOption {
  OptionEntry entry;
  /// Sets it from the text of its value, which a flag has none of. Throws: usage.
  std::function<void(const std::string& text, Arguments&)> set;
  std::string short_name = {};  ///< a letter, or none
  std::string instead_of = {};  ///< the option that cannot be given beside it
};

/// In the order of the help.
std::vector<CommandOption> command_options();

}  // namespace isoshell::tool
