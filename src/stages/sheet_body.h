// build_sheet (see stages.h), written once over an executor.
#pragma once

#include "isoshell/error.h"
#include "isoshell/stages.h"

namespace isoshell {

template <class Exec>
Sheet build_sheet_body(Exec&, const LatticeSurface&, const SiteSet&, const SiteSamples&, const SheetOptions&) {
  throw Error(ErrorCode::internal, "sheet", "build_sheet is missing");
}

}  // namespace isoshell
