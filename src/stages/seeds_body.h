// place_seeds (see stages.h), written once over an executor.
#pragma once

#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

template <class Exec>
SeedSet place_seeds_body(Exec&, const Sheet&, const SeedOptions&) {
  throw Error(ErrorCode::internal, "seeds", "place_seeds is missing");
}

template <class Exec>
SeedSet place_seeds_body(Exec&, const SiteSet&, const SiteSamples&, const SeedOptions&) {
  throw Error(ErrorCode::internal, "seeds", "place_seeds is missing");
}

}  // namespace isoshell
