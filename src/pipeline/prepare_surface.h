// Sites, samples and sheet of a surface on one grid.
#pragma once

#include <optional>

#include "isoshell/remesh.h"

namespace isoshell {

/// With the closing that is asked for, or the least one that lets nothing leak in. Walls without thickness are grown,
/// and surfaces that are open on both sides.
Prepared prepare_surface(LatticeSurface surface, std::optional<int32_t> closing_vox, const RemeshOptions& options,
                         RemeshReport& report, Context& context);

}  // namespace isoshell
