// Options to JSON and back: what stage files, statistics and jobs hold.
#pragma once

#include <string>
#include <vector>

#include "isoshell/remesh.h"

namespace isoshell {

/// Options as a person gave them. A run that resumes from a stage file takes those from the file that were not given.
struct AskedOptions {
  RemeshOptions values;
  std::string sizing;              ///< where the sizing field is, as read_sizing takes it; empty: even edges
  std::vector<std::string> given;  ///< names of the options that were given, as JSON and the command have them; a run
                                   ///< from a stage file or with a sizing field drops values that are not named here

  bool was_given(const std::string& name) const;
};

/// Options that were set in C++: given is what differs from the defaults. What a run should hold to though it is a
/// default, such as 10000 vertices beside a sizing field, is for the caller to add to `given`.
AskedOptions asked_options(RemeshOptions values, std::string sizing = "");

/// One object on one line, with every option of a run under its name of the command and the number that stands for what
/// has no value: 0, or -1 for the tolerance. What of the sizing's name is not UTF-8 becomes U+FFFD. "close-gaps" is
/// "auto", voxels as "4vox", or a width in world units.
std::string options_json(const RemeshOptions& options);

enum class UnknownOptions {
  refuse,
  pass_over,  ///< of later versions
};
/// Takes what the object has; the others keep their defaults, as does what is null. Throws: unreadable_input for text
/// that is no object; usage for a value out of range or of another type, and for an unknown name unless it is to be
/// passed over.
AskedOptions parse_options_json(const std::string& json, UnknownOptions unknown = UnknownOptions::refuse);

/// The paper's loop has even cells. Throws: usage for that with a sizing field or adaptivity.
void check_method(const AskedOptions& options);

}  // namespace isoshell
