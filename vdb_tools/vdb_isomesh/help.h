// The text of --help. The table of options in docs/guide/command.md is made from it.
#pragma once

#include <string>

namespace CLI {
class App;
}

namespace isoshell::tool {

std::string help_text(const CLI::App& app);
/// The same without the exit statuses, which are each command's own.
std::string options_text(const CLI::App& app);
std::string version_text(const std::string& program);

/// The option of `app` closest to a mistyped one, "--name"; empty when none is close.
std::string closest_option(const CLI::App& app, const std::string& mistyped);

}  // namespace isoshell::tool
