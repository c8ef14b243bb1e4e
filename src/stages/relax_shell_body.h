// relax_in_shell (see stages.h), written once over an executor.
#pragma once

#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

template <class Exec>
RelaxReport relax_in_shell_body(Exec&, const Shell&, const SiteSet&, const SiteSamples&, SeedSet&, const RelaxOptions&) {
  throw Error(ErrorCode::internal, "relax_shell", "relax_in_shell is missing");
}

}  // namespace isoshell
