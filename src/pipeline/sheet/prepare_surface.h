// Sites, samples and sheet of a surface on one grid.
#pragma once

#include <optional>

#include "pipeline/grid/prepared_surface.h"
#include "pipeline/grid/run_log.h"

namespace isoshell {

/// With the closing that is asked for, or the least one that lets nothing leak in. Walls without thickness are grown,
/// and surfaces that are open on both sides.
PreparedSurface prepare_surface(LatticeSurface surface, std::optional<int32_t> closing_vox,
                                const RemeshOptions& options, Run& run);

/// Whether components and genus of an input can be compared with those of a sheet.
bool can_compare(const InputTopology& input);

/// How far the sheet's topology is from the input's; 0 when they agree, or when the input's is not known.
int64_t topology_gap(const PreparedSurface& p);

/// Says in p.report what there is to say of sites and sheet.
void report_sheet(PreparedSurface& p);

}  // namespace isoshell
