// What is fuzzed: every reader, by the name of its corpus folder.
#pragma once

#include <vector>

#include "isoshell/advanced/buffer.h"

namespace isoshell::fuzz {

struct Target {
  const char* name;
  void (*run)(View<const char> bytes);  ///< throws what the reader throws
};

const std::vector<Target>& targets();

/// Runs a target. A refusal is fine, anything else ends the process.
void run_or_abort(const Target& target, View<const char> bytes);

}  // namespace isoshell::fuzz
