// What a run says of the curves of its input: which of them the result has, where, and which are lost.
#pragma once

#include <string>
#include <vector>

#include "features/cutting/cut_surface.h"
#include "pipeline/grid/run_log.h"

namespace isoshell {

/// Why a curve is lost whose patches, or whose segments, have no room.
constexpr const char* kEdgesTooLong = "the edges are too long for it";

/// "border", "edge of three faces", "crease", "seam" or "line".
const char* name_of(CurveKind kind);

int64_t count_kind(const CurveNetwork& network, CurveKind kind);

/// Fills in what was found. Borders of the input count as loops that are kept when `keeps_borders`.
void report_found(const FeatureMesh& mesh, const CurveNetwork& network, bool keeps_borders, FeatureReport& report);

/// Warns of edges of more than two faces, once, and says where: no result has them.
void warn_of_branches(const FeatureMesh& mesh, const CurveNetwork& network, std::vector<std::string>& warnings);

/// Every curve as the report names it, should it be lost.
std::vector<LostCurve> describe(const FeatureMesh& mesh, const CurveNetwork& network);

/// Says that some of the curves are not kept while others are, and warns.
void report_left_out(const std::vector<LostCurve>& curves, const LatticeFrame& frame, FeatureReport& report, Run& run);

/// Warns of poor triangles that are left because looking at all of them would take too long.
void warn_of_left_alone(int64_t triangles, Run& run);

/// Says that none of the curves is kept, and warns.
void give_up(const std::vector<LostCurve>& curves, const std::string& why, FeatureReport& report, Run& run);

}  // namespace isoshell
