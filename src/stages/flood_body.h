// flood_shell (see stages.h), written once over an executor.
#pragma once

#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

template <class Exec>
VoronoiLabels flood_shell_body(Exec&, const Shell&, const SeedSet&) {
  throw Error(ErrorCode::internal, "flood", "flood_shell is missing");
}

}  // namespace isoshell
