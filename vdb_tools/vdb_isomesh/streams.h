// Standard streams.
#pragma once

#include <string>

namespace isoshell::tool {

/// Takes the places of standard streams that are closed, so that no file gets their numbers: reading from and writing
/// to them stay errors. Called before anything is opened.
void fill_closed_streams();

/// To standard output. Throws: unwritable_output.
void print(const std::string& text);

}  // namespace isoshell::tool
