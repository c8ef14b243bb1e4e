// sample_sites (see stages.h), written once over an executor.
#pragma once

#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

template <class Exec>
SiteSamples sample_sites_body(Exec&, const LatticeSurface&, const SiteSet&) {
  throw Error(ErrorCode::internal, "samples", "sample_sites is missing");
}

}  // namespace isoshell
