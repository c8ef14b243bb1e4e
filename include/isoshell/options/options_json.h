// Options to JSON and back: what stage files, statistics and jobs hold.
#pragma once

#include <string>

#include "isoshell/options/requested_options.h"

namespace isoshell {

/// One object on one line, with every option of a run under its name of the command and the number that stands for what
/// has no value: 0, or -1 for the tolerance. What of the sizing's name is not UTF-8 becomes U+FFFD. "close-gaps" is
/// "auto", voxels as "4vox", or a width in world units.
std::string options_json(const RunOptions& options);

enum class UnknownOptions {
  refuse,
  pass_over,  ///< of later versions
};
/// Takes what the object has; the others keep their defaults, as does what is null. Throws: unreadable_input for text
/// that is no object; usage for a value out of range or of another type, and for an unknown name unless it is to be
/// passed over.
RequestedOptions parse_options_json(const std::string& json, UnknownOptions unknown = UnknownOptions::refuse);

}  // namespace isoshell
