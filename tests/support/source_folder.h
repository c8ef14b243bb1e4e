// Where tests find the files they read and the command they run. A bundle has its own places and names them in the
// environment.
#pragma once

#include <string>

namespace isoshell {

/// The environment variable ISOSHELL_SOURCE, or the source folder of the build.
std::string source_folder();

}  // namespace isoshell
