// triangulate_dual (see stages.h), written once over an executor.
#pragma once

#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

template <class Exec>
DualMesh triangulate_dual_body(Exec&, const Sheet&, SeedSet&, const DualOptions&, DualReport&) {
  throw Error(ErrorCode::internal, "dual", "triangulate_dual is missing");
}

}  // namespace isoshell
