// Options as a person gave them.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "isoshell/remesh.h"

namespace isoshell {

/// What is asked of a run: what is asked of remesh(), and what only a run with files knows.
struct RunOptions : RemeshOptions {
  RunOptions(RemeshOptions of_mesh = {})  // NOLINT(google-explicit-constructor): a run without more
      : RemeshOptions(std::move(of_mesh)) {}

  std::string line_file;  ///< where `features.lines` are read from; empty: they are as they were set
  /// Names of the attributes that the result keeps, and whose seams are its edges; without a value all.
  std::optional<std::vector<std::string>> attributes;
  bool color_features = false;  ///< colours patches, curves and corners, and writes the curves' edges to PLY

  bool has_lines() const { return features.lines || !line_file.empty(); }
};

/// A run that resumes from a stage file takes those options from the file that were not given.
struct RequestedOptions {
  RunOptions values;
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
RequestedOptions requested_options(RunOptions values, std::string sizing = "");

/// Options that need or rule out others: what the paper's loop cannot do, which are curves, borders, frames and cells
/// that are not even, and --snap of no regions. Throws: usage for one of them.
void check_together(const RequestedOptions& options);

}  // namespace isoshell
