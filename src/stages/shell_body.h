// build_shell (see stages.h), written once over an executor.
#pragma once

#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

template <class Exec>
Shell build_shell_body(Exec&, const SiteSet&, const ShellOptions&) {
  throw Error(ErrorCode::internal, "shell", "build_shell is missing");
}

}  // namespace isoshell
