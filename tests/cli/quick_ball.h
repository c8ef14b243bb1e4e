// A ball as a file, and options with which the command is soon done with it.
#pragma once

#include <string>

#include "cli/command.h"

namespace isoshell::cli {

inline const std::string kQuick = " --vertices 300 --resolution 48 ";

inline void write_ball(const Folder& folder) { folder.write_off("ball.off", shapes::sphere({1, 2, 3}, 5, 48)); }

}  // namespace isoshell::cli
