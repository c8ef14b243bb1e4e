// Options as a person gave them.
#pragma once

#include <string>
#include <vector>

#include "isoshell/remesh.h"

namespace isoshell {

/// A run that resumes from a stage file takes those options from the file that were not given.
struct RequestedOptions {
  RemeshOptions values;
  std::string sizing;              ///< where the sizing field is, as read_sizing takes it; empty: even edges
  std::vector<std::string> given;  ///< names of the options that were given, as JSON and the command have them; a run
                                   ///< from a stage file or with a sizing field drops values that are not named here

  bool was_given(const std::string& name) const;
  /// Whether edge lengths by place or region say how many vertices there are.
  bool lengths_decide() const {
    return (!sizing.empty() || !values.region_edge_lengths.empty()) && !was_given("vertices");
  }
};

/// Options that were set in C++: given is what differs from the defaults. What a run should hold to though it is a
/// default, such as 10000 vertices beside a sizing field, is for the caller to add to `given`.
RequestedOptions requested_options(RemeshOptions values, std::string sizing = "");

/// What the paper's loop cannot do: curves, borders, frames and cells that are not even. Throws: usage for that with
/// one of them.
void check_method(const RequestedOptions& options);

}  // namespace isoshell
