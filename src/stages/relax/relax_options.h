// What both methods of relaxation take as options.
#pragma once

#include <string>

#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"

namespace isoshell {

inline void require_relax_options(const RelaxOptions& options) {
  const auto require = [](const char* name, int64_t value) {
    if (value < 0)
      throw Error(ErrorCode::usage, "relax",
                  std::string(name) + " is " + std::to_string(value) + "; it must be 0 or more");
  };
  require("max_passes", options.max_passes);
  require("tolerance_ppb", options.tolerance_ppb);
  require("max_step_q8", options.max_step_q8);
}

}  // namespace isoshell
