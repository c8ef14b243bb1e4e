// relax_on_sheet (see stages.h), written once over an executor.
#pragma once

#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

template <class Exec>
RelaxReport relax_on_sheet_body(Exec&, const Sheet&, SeedSet&, const RelaxOptions&) {
  throw Error(ErrorCode::internal, "relax_sheet", "relax_on_sheet is missing");
}

}  // namespace isoshell
