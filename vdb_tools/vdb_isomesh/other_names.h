// What other programs call the options of this one.
#pragma once

#include <string>

namespace isoshell::tool {

/// The option, as "--vertices", that is meant by a name that others have for it, without dashes; empty for any other
/// name.
std::string option_of_others(const std::string& name);

}  // namespace isoshell::tool
