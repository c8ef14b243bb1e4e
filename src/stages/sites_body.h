// voxelize (see stages.h), written once over an executor.
#pragma once

#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

template <class Exec>
SiteSet voxelize_body(Exec&, const LatticeSurface&) {
  throw Error(ErrorCode::internal, "sites", "voxelize is missing");
}

}  // namespace isoshell
