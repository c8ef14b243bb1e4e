// Finer grids, where the sheet does not show the topology of the input.
#pragma once

#include <functional>
#include <optional>

#include "isoshell/remesh.h"

namespace isoshell {

/// How far the sheet's topology is from the input's; 0 when they agree, or when the input's is not known.
int64_t topology_gap(const Prepared& p);

/// Whether a finer grid than the first one may be taken for the sake of the topology: the user has left it to the run,
/// and there are vertices enough to show all parts.
bool may_refine(const RemeshOptions& options, const InputTopology& input);

/// The closing that the options ask for on a grid; none where the run finds it.
std::optional<int32_t> asked_closing(const RemeshOptions& options, const InputTopology& input,
                                     const LatticeFrame& frame);

/// Products of a soup on one grid. Throws: as prepare.
Prepared prepare_on_grid(const TriangleSoup& soup, const InputTopology& input, int32_t resolution,
                         const RemeshOptions& options, RemeshReport& report, Context& context);

/// False when a refinement does not fit the memory limit, which is only worth a warning. Throws: out_of_memory when
/// nothing was made yet.
bool memory_allows(const TriangleSoup& soup, const InputTopology& input, const RemeshOptions& options,
                   int32_t resolution, bool refining, RemeshReport& report, const Context& context);

/// The coarsest of finer grids than that of `coarse` whose sheet has the input's topology, or the one that comes
/// nearest to it, or one that is enough anyway; at most four times as fine as the first choice. None where none is
/// better.
std::optional<Prepared> finer_grid(const TriangleSoup& soup, const Prepared& coarse,
                                   const std::function<bool(Prepared&)>& is_enough, const RemeshOptions& options,
                                   RemeshReport& report, Context& context);

/// The same from what was prepared, for a sheet that is needed after all: the run was to take the input's own
/// triangles. With edge lengths; says in the report what the sheet is now.
std::optional<Prepared> finer_grid_after_all(const Prepared& coarse, const RemeshOptions& options, RemeshReport& report,
                                             Context& context);

/// Says what the sheet is.
void report_sheet(const Prepared& p, RemeshReport& report);

}  // namespace isoshell
